//! Files made to hurt: time and memory stay bounded, nothing recurses.

use nc_syntax::{Block, Invalid, ItemKind, MAX_BLOCK_BYTES, Reader};

use crate::common;

/// Number of blocks, the kinds of items seen (invalid ones only), and the most items kept at once.
fn read(text: &[u8]) -> (usize, Vec<Invalid>, usize) {
    let marks = common::conventional();
    let (mut reader, mut block) = (Reader::new(text, &marks), Block::default());
    let (mut blocks, mut wrong) = (0, Vec::new());
    while reader.next(&mut block) {
        blocks += 1;
        for item in &block.items {
            if let ItemKind::Invalid(why) = item.kind
                && !wrong.contains(&why)
            {
                wrong.push(why);
            }
        }
    }
    (blocks, wrong, block.items.capacity())
}

#[test]
fn one_long_line() {
    let (blocks, wrong, kept) = read(&vec![b'G'; 64 << 20]);
    assert_eq!((blocks, wrong), (1, vec![Invalid::TooLong]));
    assert!(kept <= MAX_BLOCK_BYTES);
    let (blocks, wrong, kept) = read(&b"X1 ".repeat(10 << 20));
    assert_eq!((blocks, wrong), (1, vec![Invalid::TooLong]));
    assert!(kept <= MAX_BLOCK_BYTES);
}

#[test]
fn many_short_blocks_on_one_line() {
    let (blocks, wrong, _) = read(&b"X1;".repeat(1 << 20));
    assert_eq!((blocks, wrong), (1 << 20, vec![]));
    assert_eq!(read(&b";".repeat(1 << 20)).0, 1 << 20);
}

#[test]
fn nested_brackets() {
    let line = [b"X".as_slice(), &b"[".repeat(30_000), b"1", &b"]".repeat(30_000)].concat();
    assert_eq!(read(&line), (1, vec![], 4));
    assert_eq!(read(&line[..50_000]).1, [Invalid::UnclosedBracket]);
    assert_eq!(read(&b"[".repeat(1_000_000)).1, [Invalid::TooLong]);
    assert_eq!(read(&b"X#".repeat(30_000)).1, [Invalid::Number]);
    assert_eq!(read(&b"(".repeat(60_000)).1, [Invalid::UnclosedComment]);
}

#[test]
fn many_percent_signs() {
    let (blocks, _, _) = read(&b"%\n".repeat(1 << 20));
    assert_eq!(blocks, 1 << 20);
    assert_eq!(read(&vec![b'%'; 60_000]).0, 1);
    assert_eq!(read(&b" %".repeat(30_000)).0, 1);
}
