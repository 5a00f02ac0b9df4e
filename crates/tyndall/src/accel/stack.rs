//! The stack of a traversal.

use std::mem::MaybeUninit;

/// A stack of fixed size without initialisation.
pub(super) struct Stack<T, const N: usize> {
    pub(super) len: usize,
    items: [MaybeUninit<T>; N],
}

impl<T: Copy + Ord, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { len: 0, items: [const { MaybeUninit::uninit() }; N] }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, item: T) {
        debug_assert!(self.len < N, "a path longer than any");
        // SAFETY: users choose `N` so that no path through their tree needs more.
        unsafe { self.items.get_unchecked_mut(self.len) }.write(item);
        self.len += 1;
    }

    /// Pushes below the smaller ones among the items from `base` on.
    #[inline(always)]
    pub(super) fn push_sorted(&mut self, base: usize, item: T) {
        let mut at = self.len;
        while at > base {
            // SAFETY: items below `len` are initialised.
            let below = unsafe { self.items[at - 1].assume_init() };
            if below >= item {
                break;
            }
            self.items[at].write(below);
            at -= 1;
        }
        self.items[at].write(item);
        self.len += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: items below the former `len` are initialised.
        Some(unsafe { self.items[self.len].assume_init() })
    }
}
