//! Error metrics of images.
