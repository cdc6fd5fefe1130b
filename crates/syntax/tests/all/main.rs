//! The reader from outside.

mod ron_reads_the_same;
