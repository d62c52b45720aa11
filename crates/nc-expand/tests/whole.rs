//! All tests of the room in one program, linked once.

mod common;

mod called;
mod drawing;
mod expressions;
mod hostile;
mod interpreter;
mod okuma;
mod pockets;
mod returns;
mod routines;
mod rules;
mod shorthand;
mod siemens;
mod turning;
