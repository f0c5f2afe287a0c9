//! Memory layout of the messages for programs in Python: `ctypes` structures of every header and element.
//!
//! The fields come from the `serde` form of a message, in the order of their definition; as all messages are `#[repr(C)]`
//! without padding, that is their layout, and sizes are compared with those of the Rust types.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::ser::{self, Impossible, Serialize, SerializeStruct, SerializeTuple};

use crate::label::Label;
use crate::messages::{ForTopic, Message};
use crate::topic::Topic;
use crate::topology::STAGES;

/// The module `messages.py`: a structure for each header and element, and a table of the topics.
pub fn python() -> String {
    let mut structures = Structures::default();
    let mut table = String::new();
    for topic in Topic::ALL {
        let (header, element, row) = topic.apply(Describe(&mut structures));
        let _ = writeln!(table, "    \"{}\": Topic({header}, {element}, {row}),", topic.name());
    }
    let mut stages = String::new();
    for stage in &STAGES {
        let _ = writeln!(stages, "    \"{}\": {},", stage.name, stage.number());
    }
    format!(
        "# Written by `just layouts` from the Rust types. Do not edit.\n\
         \"\"\"Messages of radar-chain as they lie in shared memory: SI units, radians, ns UTC.\"\"\"\n\n\
         import ctypes\nfrom typing import NamedTuple\n\n\n\
         class Topic(NamedTuple):\n    header: type\n    element: type\n    header_name: str\n    element_name: str\n    \
         header_alignment: int\n    schema: str\n    most: int\n\n\n\
         {}TOPICS = {{\n{table}}}\n\n\
         # The event by which each stage tells a publisher that it has found it.\nSTAGES = {{\n{stages}}}\n",
        structures.text
    )
}

/// Adds the structures of a topic; gives the names of header and element, and the rest of the topic's row.
struct Describe<'a>(&'a mut Structures);

impl ForTopic for Describe<'_> {
    type Out = (String, String, String);

    fn call<M: Message>(self) -> Self::Out {
        let header = self.0.describe(&M::Header::default(), size_of::<M::Header>());
        let element = self.0.describe(&M::Element::default(), size_of::<M::Element>());
        let [header_name, element_name] = [&header, &element].map(|name| type_name(M::SOURCE, name));
        let (alignment, schema, most) = (align_of::<M::Header>(), M::SCHEMA, M::MOST);
        (header, element, format!("\"{header_name}\", \"{element_name}\", {alignment}, \"{schema}\", {most}"))
    }
}

/// The name by which shared memory knows the type `name`, from the source that defines it.
fn type_name<'a>(source: &'a str, name: &str) -> &'a str {
    let definition = source.split(&format!("pub struct {name} {{")).next().filter(|before| before.len() < source.len());
    let named = definition.and_then(|before| before.rsplit_once("#[type_name(\"")?.1.split_once("\")]"));
    named.map_or("f32", |(name, _)| name) // the only element that is no structure
}

/// Python classes written so far.
#[derive(Debug, Default)]
struct Structures {
    text: String,
    sizes: BTreeMap<&'static str, usize>,
}

impl Structures {
    /// The Python name of a value's type, which is written if it is a structure that is not there yet.
    fn describe<T: Serialize>(&mut self, value: &T, size: usize) -> String {
        let field = value.serialize(Fields(self, size)).expect("messages hold numbers, names, arrays and structures");
        assert_eq!(field.size, size, "{} has bytes that no field explains", field.name);
        field.name
    }
}

/// The Python type of a field.
#[derive(Debug, Clone)]
struct Field {
    name: String,
    size: usize,
}

impl Field {
    fn new(name: &str, size: usize) -> Self {
        Self { name: name.to_string(), size }
    }
}

/// What no message holds.
#[derive(Debug)]
struct Unsupported(String);

impl std::fmt::Display for Unsupported {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unsupported {}

impl ser::Error for Unsupported {
    fn custom<T: std::fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

/// Walks through the fields of a value whose type has this size, 0 if that is the size of its fields.
struct Fields<'a>(&'a mut Structures, usize);

/// A structure being walked through.
struct StructFields<'a> {
    structures: &'a mut Structures,
    name: &'static str,
    fields: String,
    size: usize,
    /// Size of the type: what is more than the fields lies after them, where the type is aligned to a cache line.
    whole: usize,
}

/// An array being walked through.
struct Items<'a> {
    structures: &'a mut Structures,
    item: Option<Field>,
    count: usize,
}

macro_rules! numbers {
    ($($method:ident($number:ty) => $name:literal;)+) => {
        $(fn $method(self, _: $number) -> Result<Field, Unsupported> {
            Ok(Field::new($name, size_of::<$number>()))
        })+
    };
}

impl<'a> ser::Serializer for Fields<'a> {
    type Ok = Field;
    type Error = Unsupported;
    type SerializeSeq = Impossible<Field, Unsupported>;
    type SerializeTuple = Items<'a>;
    type SerializeTupleStruct = Impossible<Field, Unsupported>;
    type SerializeTupleVariant = Impossible<Field, Unsupported>;
    type SerializeMap = Impossible<Field, Unsupported>;
    type SerializeStruct = StructFields<'a>;
    type SerializeStructVariant = Impossible<Field, Unsupported>;

    numbers! {
        serialize_u8(u8) => "ctypes.c_uint8";
        serialize_u16(u16) => "ctypes.c_uint16";
        serialize_u32(u32) => "ctypes.c_uint32";
        serialize_u64(u64) => "ctypes.c_uint64";
        serialize_i8(i8) => "ctypes.c_int8";
        serialize_i16(i16) => "ctypes.c_int16";
        serialize_i32(i32) => "ctypes.c_int32";
        serialize_i64(i64) => "ctypes.c_int64";
        serialize_f32(f32) => "ctypes.c_float";
        serialize_f64(f64) => "ctypes.c_double";
    }

    /// The only text in a message is a [`Label`].
    fn serialize_str(self, _: &str) -> Result<Field, Unsupported> {
        Ok(Field { name: format!("ctypes.c_char * {}", Label::LONGEST), size: Label::LONGEST })
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Field, Unsupported> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<Field, Unsupported> {
        value.serialize(self)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Self::SerializeSeq, Unsupported> {
        Err(Unsupported("a sequence of any length".into()))
    }

    fn serialize_tuple(self, _: usize) -> Result<Items<'a>, Unsupported> {
        Ok(Items { structures: self.0, item: None, count: 0 })
    }

    fn serialize_struct(self, name: &'static str, _: usize) -> Result<StructFields<'a>, Unsupported> {
        Ok(StructFields { structures: self.0, name, fields: String::new(), size: 0, whole: self.1 })
    }

    fn serialize_bool(self, _: bool) -> Result<Field, Unsupported> {
        Err(Unsupported("a truth value".into()))
    }

    fn serialize_char(self, _: char) -> Result<Field, Unsupported> {
        Err(Unsupported("a character".into()))
    }

    fn serialize_bytes(self, _: &[u8]) -> Result<Field, Unsupported> {
        Err(Unsupported("bytes".into()))
    }

    fn serialize_none(self) -> Result<Field, Unsupported> {
        Err(Unsupported("nothing".into()))
    }

    fn serialize_unit(self) -> Result<Field, Unsupported> {
        Err(Unsupported("nothing".into()))
    }

    fn serialize_unit_struct(self, name: &'static str) -> Result<Field, Unsupported> {
        Err(Unsupported(name.into()))
    }

    fn serialize_unit_variant(self, name: &'static str, _: u32, _: &'static str) -> Result<Field, Unsupported> {
        Err(Unsupported(name.into()))
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: &T,
    ) -> Result<Field, Unsupported> {
        Err(Unsupported(name.into()))
    }

    fn serialize_tuple_struct(self, name: &'static str, _: usize) -> Result<Self::SerializeTupleStruct, Unsupported> {
        Err(Unsupported(name.into()))
    }

    fn serialize_tuple_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Unsupported> {
        Err(Unsupported(name.into()))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unsupported> {
        Err(Unsupported("a map".into()))
    }

    fn serialize_struct_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeStructVariant, Unsupported> {
        Err(Unsupported(name.into()))
    }
}

impl Items<'_> {
    fn add<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        self.item = Some(value.serialize(Fields(self.structures, 0))?);
        self.count += 1;
        Ok(())
    }

    fn finish(self) -> Result<Field, Unsupported> {
        let item = self.item.ok_or(Unsupported("an array without elements".into()))?;
        Ok(Field { name: format!("{} * {}", item.name, self.count), size: item.size * self.count })
    }
}

impl SerializeTuple for Items<'_> {
    type Ok = Field;
    type Error = Unsupported;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        self.add(value)
    }

    fn end(self) -> Result<Field, Unsupported> {
        self.finish()
    }
}

impl SerializeStruct for StructFields<'_> {
    type Ok = Field;
    type Error = Unsupported;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Unsupported> {
        let field = value.serialize(Fields(self.structures, 0))?;
        let _ = writeln!(self.fields, "        (\"{key}\", {}),", field.name);
        self.size += field.size;
        Ok(())
    }

    fn end(mut self) -> Result<Field, Unsupported> {
        let rest = self.whole.saturating_sub(self.size);
        if rest > 0 {
            let _ = writeln!(self.fields, "        (\"padding\", ctypes.c_uint8 * {rest}),");
            self.size += rest;
        }
        if self.structures.sizes.insert(self.name, self.size).is_none() {
            let Self { structures, name, fields, size, .. } = &mut self;
            let _ = writeln!(structures.text, "class {name}(ctypes.Structure):");
            let _ = writeln!(structures.text, "    _fields_ = [\n{fields}    ]  # {size} bytes\n\n");
        }
        Ok(Field::new(self.name, self.size))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_of_every_message_is_in_a_field() {
        let module = python(); // it compares the sizes
        for name in ["PlotsHeader", "Plot", "Lineage", "Stamps", "Track", "Health", "DwellHeader"] {
            assert!(module.contains(&format!("class {name}(ctypes.Structure):")), "{name}");
        }
        assert!(module.contains("(\"statistic\", ctypes.c_float),\n"));
        assert!(module.contains("(\"process\", ctypes.c_char * 32),\n"));
    }
}
