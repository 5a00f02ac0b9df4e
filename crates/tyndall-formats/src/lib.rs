//! Scene, mesh, grid and image files.
