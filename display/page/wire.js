// Messages of the server: JSON text, or a JSON header with columns of numbers behind it.

const ARRAYS = { f64: Float64Array, f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };
const text = new TextDecoder();

const aligned = (bytes) => (bytes + 7) & ~7;

/**
 * One message as an object. Columns become typed arrays in `data`, by name; they are views of `frame`, not copies.
 * @param {string | ArrayBuffer} frame
 */
export function decode(frame) {
  if (typeof frame === "string") return JSON.parse(frame);
  if (frame.byteLength < 4) throw new Error(`frame of ${frame.byteLength} bytes, expected at least 4`);
  const length = new DataView(frame).getUint32(0, true);
  if (4 + length > frame.byteLength) {
    throw new Error(`header of ${length} bytes in a frame of ${frame.byteLength}`);
  }
  const message = JSON.parse(text.decode(new Uint8Array(frame, 4, length)));
  message.data = {};
  let at = aligned(4 + length);
  for (const { name, as } of message.columns) {
    const Column = ARRAYS[as];
    if (!Column) throw new Error(`column ${name} is ${as}, expected one of ${Object.keys(ARRAYS).join(", ")}`);
    const bytes = message.count * Column.BYTES_PER_ELEMENT;
    if (at + bytes > frame.byteLength) {
      throw new Error(`column ${name} ends at byte ${at + bytes} of a frame of ${frame.byteLength}`);
    }
    message.data[name] = new Column(frame, at, message.count);
    at += aligned(bytes);
  }
  return message;
}
