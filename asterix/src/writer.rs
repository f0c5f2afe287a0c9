//! Blocks written field by field, straight into the octets that will be sent.

use crate::block::HEADER;
use crate::definition::Edition;
use crate::error::EncodeError;
use crate::field::Field;
use crate::value::RecordValues;

/// A block of records of one edition, at the end of a buffer.
///
/// ```
/// use asterix::{BlockWriter, Field, field, tables::CAT034_1_29};
///
/// const MESSAGE_TYPE: Field = field!(CAT034_1_29, "000");
/// const SAC: Field = field!(CAT034_1_29, "010/SAC");
/// const SIC: Field = field!(CAT034_1_29, "010/SIC");
/// const TIME_OF_DAY: Field = field!(CAT034_1_29, "030");
///
/// let mut datagram = Vec::new();
/// let mut block = BlockWriter::new(CAT034_1_29, &mut datagram);
/// block.record(|record| {
///     record.put_raw(&SAC, 25)?;
///     record.put_raw(&SIC, 7)?;
///     record.put_raw(&MESSAGE_TYPE, 1)?;
///     record.put(&TIME_OF_DAY, 43_200.0)
/// })?;
/// assert_eq!(datagram, [34, 0, 10, 0xe0, 25, 7, 1, 0x54, 0x60, 0x00]);
/// # Ok::<(), asterix::EncodeError>(())
/// ```
#[derive(Debug)]
pub struct BlockWriter<'a> {
    edition: &'static Edition,
    out: &'a mut Vec<u8>,
    start: usize,
}

impl<'a> BlockWriter<'a> {
    /// A block without records.
    pub fn new(edition: &'static Edition, out: &'a mut Vec<u8>) -> Self {
        let start = out.len();
        out.extend([edition.category, 0, HEADER as u8]);
        Self { edition, out, start }
    }

    /// Size of the block, octets.
    pub fn octets(&self) -> usize {
        self.out.len() - self.start
    }

    /// Appends the record that `write` writes.
    ///
    /// # Errors
    /// That of `write`, or the block is full; the block stays as it was.
    #[inline]
    pub fn record(
        &mut self,
        write: impl FnOnce(&mut RecordWriter<'_>) -> Result<(), EncodeError>,
    ) -> Result<(), EncodeError> {
        let before = self.out.len();
        let mut record = RecordWriter::new(self.edition, self.out);
        let written = write(&mut record);
        record.close();
        self.close(before, written)
    }

    /// Appends a record of values.
    ///
    /// # Errors
    /// [`EncodeError`]; the block stays as it was.
    pub fn values(&mut self, record: &RecordValues) -> Result<(), EncodeError> {
        let before = self.out.len();
        let written = record.encode(self.out);
        self.close(before, written)
    }

    fn close(&mut self, before: usize, written: Result<(), EncodeError>) -> Result<(), EncodeError> {
        let octets = self.octets();
        let fits = u16::try_from(octets);
        let result =
            written.and(fits.map_err(|_| EncodeError::BlockTooLong { category: self.edition.category, octets }));
        match result {
            Ok(length) => {
                self.out[self.start + 1..self.start + HEADER].copy_from_slice(&length.to_be_bytes());
                Ok(())
            }
            Err(error) => {
                self.out.truncate(before);
                Err(error)
            }
        }
    }
}

/// A record; its items are written in the order of the profile.
#[derive(Debug)]
pub struct RecordWriter<'a> {
    out: &'a mut Vec<u8>,
    fspec: Named,
    /// The item that is being written.
    position: Option<usize>,
    /// The parts of the item, if it is compound, and the one that is being written.
    parts: Option<Named>,
    part: Option<usize>,
    /// Where the octets of the item or of the part begin.
    start: usize,
}

/// A field of bits like the FSPEC, in front of what it names. There is room for the longest until what is named is known.
#[derive(Debug, Clone, Copy)]
struct Named {
    start: usize,
    room: usize,
    /// The highest bit is the first.
    bits: u64,
}

impl Named {
    #[inline]
    fn open(out: &mut Vec<u8>, most: usize) -> Self {
        let (start, room) = (out.len(), most.div_ceil(7).clamp(1, 9));
        out.resize(start + room, 0);
        Self { start, room, bits: 0 }
    }

    /// None if there is no room for what is to be named: it is of another edition.
    #[inline]
    fn set(&mut self, index: usize) -> Option<()> {
        if index >= self.room * 7 {
            return None;
        }
        self.bits |= 1 << 63 >> index;
        Some(())
    }

    /// Writes the bits and takes back the room that they do not need.
    #[inline]
    fn close(&self, out: &mut Vec<u8>) {
        let last = 63_usize.saturating_sub(self.bits.trailing_zeros() as usize);
        let octets = last / 7 + 1;
        for octet in 0..octets {
            let named = (self.bits >> (57 - 7 * octet)) as u8 & 0x7f;
            out[self.start + octet] = named << 1 | u8::from(octet + 1 < octets);
        }
        let (end, unused) = (self.start + self.room, self.room - octets);
        if unused > 0 {
            out.copy_within(end.., end - unused);
            out.truncate(out.len() - unused);
        }
    }
}

impl<'a> RecordWriter<'a> {
    #[inline]
    fn new(edition: &Edition, out: &'a mut Vec<u8>) -> Self {
        let most = edition.profiles.iter().map(|profile| profile.slots.len()).max().unwrap_or(0);
        let fspec = Named::open(out, most);
        let start = out.len();
        Self { out, fspec, position: None, parts: None, part: None, start }
    }

    #[inline]
    fn close(&mut self) {
        self.close_item();
        self.fspec.close(self.out);
    }

    #[inline]
    fn close_item(&mut self) {
        if let Some(parts) = self.parts.take() {
            parts.close(self.out);
        }
    }

    /// Writes the bits of an element.
    ///
    /// # Errors
    /// [`EncodeError`]: they are more than it has, or the item is not in order.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn put_raw(&mut self, field: &Field, raw: u64) -> Result<(), EncodeError> {
        let most = u64::MAX >> (64 - field.bits);
        if raw > most {
            return Err(EncodeError::Range { item: field.item, value: raw as f64, least: 0.0, most: most as f64 });
        }
        self.open(field)?;
        let (from, to) = (usize::from(field.first_bit) / 8, usize::from(field.first_bit + field.bits).div_ceil(8));
        if field.octets.is_none() {
            self.extend_to(to);
        }
        let below = to * 8 - usize::from(field.first_bit + field.bits);
        let aligned = (u128::from(raw) << below << (128 - 8 * (to - from))).to_be_bytes();
        let octets = self.out.get_mut(self.start + from..self.start + to);
        for (octet, bits) in octets.ok_or(EncodeError::Edition { item: field.item })?.iter_mut().zip(aligned) {
            *octet |= bits;
        }
        Ok(())
    }

    /// Begins the first or the next link of the chained item of a field: what is put from here on is of that.
    ///
    /// # Errors
    /// [`EncodeError`]: the item is not in order.
    #[inline]
    pub fn begin_link(&mut self, field: &Field) -> Result<(), EncodeError> {
        if self.position != Some(field.position) {
            return self.begin(field);
        }
        if let Some(last) = self.out.last_mut() {
            *last |= 1;
        }
        self.start = self.out.len();
        self.out.resize(self.start + field.octets.unwrap_or(0), 0);
        Ok(())
    }

    /// Writes a value in the unit of the specification, rounded to a whole number of steps.
    ///
    /// # Errors
    /// [`EncodeError`]: the field cannot hold it, or the item is not in order.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn put(&mut self, field: &Field, value: f64) -> Result<(), EncodeError> {
        let (least, most) = limits(field);
        let steps = round(value / field.step);
        if !(least..=most).contains(&steps) {
            let (least, most) = (least * field.step, most * field.step);
            return Err(EncodeError::Range { item: field.item, value, least, most });
        }
        self.put_raw(field, steps as i64 as u64 & (u64::MAX >> (64 - field.bits)))
    }

    /// Writes the value that is nearest to one that the field may not be able to hold; NaN is written as the least.
    ///
    /// # Errors
    /// [`EncodeError`]: the item is not in order.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn put_nearest(&mut self, field: &Field, value: f64) -> Result<(), EncodeError> {
        let (least, most) = limits(field);
        self.put(field, value.max(least * field.step).min(most * field.step))
    }

    /// Writes an angle: a whole turn is 0 again.
    ///
    /// # Errors
    /// [`EncodeError`]: the value is not finite, or the item is not in order.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn put_angle(&mut self, field: &Field, value: f64) -> Result<(), EncodeError> {
        let steps = round(value / field.step);
        if !steps.is_finite() {
            return self.put(field, value);
        }
        self.put_raw(field, steps as i64 as u64 & (u64::MAX >> (64 - field.bits)))
    }

    /// Goes to the item of a field, and to the part that the field lies in.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    fn open(&mut self, field: &Field) -> Result<(), EncodeError> {
        if self.position != Some(field.position) {
            self.begin(field)?;
        }
        if let Some((_, part)) = field.part
            && self.part != Some(part)
        {
            if self.part.is_some_and(|open| open > part) {
                return Err(EncodeError::Order { item: field.item });
            }
            if let Some(parts) = &mut self.parts {
                parts.set(part).ok_or(EncodeError::Edition { item: field.item })?;
            }
            self.part = Some(part);
            self.start = self.out.len();
            self.out.resize(self.start + field.octets.unwrap_or(0), 0);
        }
        Ok(())
    }

    #[inline]
    fn begin(&mut self, field: &Field) -> Result<(), EncodeError> {
        if self.position.is_some_and(|open| open > field.position) {
            return Err(EncodeError::Order { item: field.item });
        }
        self.close_item();
        self.fspec.set(field.position).ok_or(EncodeError::Edition { item: field.item })?;
        self.position = Some(field.position);
        self.part = None;
        self.start = self.out.len();
        match field.part {
            Some((parts, _)) => self.parts = Some(Named::open(self.out, parts.len())),
            None => self.out.resize(self.start + field.octets.unwrap_or(0), 0),
        }
        Ok(())
    }

    /// Makes an extended item, or part, at least so many octets long.
    #[inline]
    fn extend_to(&mut self, octets: usize) {
        while self.out.len() - self.start < octets {
            if self.out.len() > self.start
                && let Some(last) = self.out.last_mut()
            {
                *last |= 1;
            }
            self.out.push(0);
        }
    }
}

/// The nearest whole number, the even one of two, of values below 2⁵¹: what is added leaves no room for a fraction.
#[inline]
fn round(value: f64) -> f64 {
    const NO_FRACTION: f64 = 1.5 * (1_u64 << 52) as f64;
    (value + NO_FRACTION) - NO_FRACTION
}

/// Least and most steps that a field can hold.
#[inline]
fn limits(field: &Field) -> (f64, f64) {
    let values = (1_u128 << field.bits) as f64;
    if field.signed { (-values / 2.0, values / 2.0 - 1.0) } else { (0.0, values - 1.0) }
}
