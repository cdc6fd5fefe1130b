//! Parameters in workbooks, there and back.

mod bad_books;
mod round_trip;
