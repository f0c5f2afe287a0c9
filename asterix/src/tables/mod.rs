//! The editions: one table for each specification in the folder `specs`.
//!
//! Generated from the specifications by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

use crate::definition::Edition;

#[rustfmt::skip]
mod cat001_1_4;
pub use cat001_1_4::CAT001_1_4;
#[rustfmt::skip]
mod cat002_1_2;
pub use cat002_1_2::CAT002_1_2;
#[rustfmt::skip]
mod cat010_1_1;
pub use cat010_1_1::CAT010_1_1;
#[rustfmt::skip]
mod cat034_1_29;
pub use cat034_1_29::CAT034_1_29;
#[rustfmt::skip]
mod cat048_1_32;
pub use cat048_1_32::CAT048_1_32;
#[rustfmt::skip]
mod cat062_1_21;
pub use cat062_1_21::CAT062_1_21;
#[rustfmt::skip]
mod cat063_1_7;
pub use cat063_1_7::CAT063_1_7;
#[rustfmt::skip]
mod cat065_1_6;
pub use cat065_1_6::CAT065_1_6;
#[rustfmt::skip]
mod cat240_1_3;
pub use cat240_1_3::CAT240_1_3;

/// All editions, by category, the oldest first.
pub const ALL: [&Edition; 9] =
    [CAT001_1_4, CAT002_1_2, CAT010_1_1, CAT034_1_29, CAT048_1_32, CAT062_1_21, CAT063_1_7, CAT065_1_6, CAT240_1_3];
