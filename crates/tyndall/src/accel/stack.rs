//! The stack of a traversal.

use std::mem::MaybeUninit;

/// The memory of a stack, without initialisation. Its user counts what is in it, so that the count stays in a register.
pub(super) struct Stack<T, const N: usize> {
    items: [MaybeUninit<T>; N],
}

impl<T: Copy + Ord, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { items: [const { MaybeUninit::uninit() }; N] }
    }

    /// Puts an item down at `at`, which is the number of those below.
    #[inline(always)]
    pub(super) fn set(&mut self, at: usize, item: T) {
        debug_assert!(at < N, "a path longer than any");
        // SAFETY: users choose `N` so that no path through their tree needs more.
        unsafe { self.items.get_unchecked_mut(at) }.write(item);
    }

    /// The item at `at`, where one was put down.
    #[inline(always)]
    pub(super) fn get(&self, at: usize) -> T {
        debug_assert!(at < N, "a path longer than any");
        // SAFETY: within the stack as above, and initialised.
        unsafe { self.items.get_unchecked(at).assume_init() }
    }

    /// Adds to `len` items one, below the smaller ones among those from `base` on.
    #[inline(always)]
    pub(super) fn insert(&mut self, base: usize, len: usize, item: T) {
        let mut at = len;
        while at > base {
            let below = self.get(at - 1);
            if below >= item {
                break;
            }
            self.set(at, below);
            at -= 1;
        }
        self.set(at, item);
    }
}
