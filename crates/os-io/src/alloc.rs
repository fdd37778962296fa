//! An allocator that counts allocations in some sections of a program. A program that may not allocate after its start
//! installs [`Counting`] as its allocator, and runs each tick inside a [`Section`]. Allocations of other threads, or
//! between sections, are not counted. Control processes of RCS-II/T3 are built without `alloc`; the code around them
//! could allocate (docs/design/tick.md "No allocation").

#![allow(unsafe_code, reason = "GlobalAlloc is an unsafe trait; every call is passed on unchanged")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    marker::PhantomData,
    sync::atomic::{AtomicU64, Ordering},
};

static IN_SECTIONS: AtomicU64 = AtomicU64::new(0);

thread_local! {
    // Because of the constant initialisation without a destructor, an access never allocates.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// The system's allocator, which counts the allocations inside a [`Section`].
///
/// ```
/// #[global_allocator]
/// static ALLOCATOR: os_io::alloc::Counting = os_io::alloc::Counting;
/// # fn main() {
/// assert!(os_io::alloc::is_installed());
/// # }
/// ```
pub struct Counting;

/// While a section exists, the allocations of its thread are counted.
pub struct Section {
    not_send: PhantomData<*const ()>, // it belongs to the thread that entered it
}

impl Section {
    /// Count from here until the section is dropped. Sections may be nested.
    #[must_use]
    pub fn enter() -> Self {
        DEPTH.with(|depth| depth.set(depth.get().saturating_add(1)));
        Self { not_send: PhantomData }
    }
}

impl Drop for Section {
    fn drop(&mut self) {
        DEPTH.with(|depth| depth.set(depth.get().saturating_sub(1)));
    }
}

/// Number of allocations inside sections of all threads. Without [`Counting`] ([`is_installed`]) it stays 0.
#[must_use]
pub fn allocations() -> u64 {
    IN_SECTIONS.load(Ordering::Relaxed)
}

/// True if the program runs on [`Counting`], as an uncounted allocation shows.
#[must_use]
pub fn is_installed() -> bool {
    let before = allocations();
    {
        let _section = Section::enter();
        drop(std::hint::black_box(Box::new(0_u64)));
    }
    let counted = allocations() > before;
    if counted {
        IN_SECTIONS.fetch_sub(1, Ordering::Relaxed);
    }
    counted
}

fn count() {
    let inside = DEPTH.try_with(|depth| depth.get() > 0).unwrap_or(false);
    if inside {
        IN_SECTIONS.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: every method passes its arguments unchanged to `System`, which upholds the contract; `count` neither
// allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc`, which is that of `System::alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc_zeroed`, which is that of `System::alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        // SAFETY: `block` came from `System`, with `layout`; the caller guarantees the rest.
        unsafe { System.realloc(block, layout, new_size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: `block` came from this allocator, hence from `System`, with `layout`.
        unsafe { System.dealloc(block, layout) }
    }
}
