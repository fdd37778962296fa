//! One loop reuses its buffer; the other allocates in each tick and is detected: `cargo run --release -p os-io
//! --example section`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use os_io::alloc::{Counting, Section, allocations};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count(mut tick: impl FnMut()) -> u64 {
    let before = allocations();
    let section = Section::enter();
    for _ in 0..100 {
        tick();
    }
    drop(section);
    allocations() - before
}

fn main() {
    let mut kept = Vec::with_capacity(16);
    let keeps = count(|| {
        kept.clear();
        kept.extend(0..16_u8);
    });
    let makes = count(|| drop(std::hint::black_box((0..16_u8).collect::<Vec<_>>())));
    println!("buffer kept: {keeps} allocations; made again: {makes}");
    assert_eq!((keeps, makes), (0, 100));
}
