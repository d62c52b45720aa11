//! All tests of the room in one program, linked once.

mod corpus;
mod documentation;
mod messages;
