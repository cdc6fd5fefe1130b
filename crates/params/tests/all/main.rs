//! Parameters in workbooks, there and back.

mod bad_books;
mod both_sides;
mod round_trip;
