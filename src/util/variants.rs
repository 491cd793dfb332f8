//! The variants of an enum as an array, which can be mapped to another; strum has them as a slice.

/// All of them, in their order.
pub const fn array<T: Copy, const N: usize>(variants: &[T]) -> [T; N] {
    let mut all = [variants[0]; N];
    all.copy_from_slice(variants);
    all
}
