//! Messages as rows of tables: one row per element, the columns of the header that place it first.
//!
//! A vector takes a column per component, named as in the state: `x_m`, `vx_mps` and so on. Each message file says which
//! columns its elements have ([`Row`]); an export says what a table is ([`Table`]).

use std::io;

/// A value of a column.
#[derive(Debug, Clone, Copy)]
pub enum Value<'a> {
    /// A count or code.
    U32(u32),
    /// A number, position or time.
    U64(u64),
    /// A measured value of single precision.
    F32(f32),
    /// A measured or computed value.
    F64(f64),
    /// A name.
    Text(&'a str),
}

/// What takes rows, value by value.
pub trait Table {
    /// The next value of the row.
    ///
    /// # Errors
    /// The table cannot be written.
    fn put(&mut self, column: &str, value: Value<'_>) -> io::Result<()>;

    /// The next value of the row, in a column whose values are not always known.
    ///
    /// # Errors
    /// The table cannot be written.
    fn put_if(&mut self, known: bool, column: &str, value: Value<'_>) -> io::Result<()>;

    /// Ends the row.
    ///
    /// # Errors
    /// The table cannot be written.
    fn end_row(&mut self) -> io::Result<()>;
}

/// An element as a row; `H` is the header of its message.
pub trait Row<H> {
    /// Puts its columns into `table`, always the same ones, and leaves the row open.
    ///
    /// # Errors
    /// The table cannot be written.
    fn put_row(&self, header: &H, table: &mut dyn Table) -> io::Result<()>;

    /// Where it is, east, north and up of the antenna, m; `None` of what is nowhere or says its place itself.
    fn position_m(&self) -> Option<[f64; 3]> {
        None
    }
}

/// Puts a value into each of the columns.
pub(crate) fn put_all<const N: usize>(columns: &[&str; N], values: &[f64; N], table: &mut dyn Table) -> io::Result<()> {
    columns.iter().zip(values).try_for_each(|(column, &value)| table.put(column, Value::F64(value)))
}
