//! Meshes, grids and pictures, each read once.

use crate::{FileError, grid, image, mesh};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tyndall::scene::desc::{GridDesc, ImageDesc, MeshDesc};

/// How a mesh file is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct MeshOptions {
    /// Flat shading: no vertex normals, stored or computed.
    pub(super) face_normals: bool,
    /// v becomes 1 - v.
    pub(super) flip_tex_coords: bool,
    /// Which mesh of a .serialized file.
    pub(super) shape_index: usize,
}

/// What has been read.
#[derive(Default)]
pub(super) struct Assets {
    meshes: HashMap<(PathBuf, MeshOptions), Arc<MeshDesc>>,
    grids: HashMap<PathBuf, Arc<GridDesc>>,
    images: HashMap<(PathBuf, bool), Arc<ImageDesc>>,
}

impl Assets {
    /// A mesh by the name of its format.
    pub(super) fn mesh(&mut self, format: &str, path: &Path, options: MeshOptions) -> Result<Arc<MeshDesc>, String> {
        shared(&mut self.meshes, (path.to_path_buf(), options), || {
            let mut mesh = match format {
                "obj" => mesh::obj::read(path)?,
                "ply" => mesh::ply::read(path)?,
                _ => mesh::serialized::read(path, options.shape_index)?,
            };
            if options.flip_tex_coords {
                mesh.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
            }
            if options.face_normals {
                mesh.normals.clear();
            }
            Ok(mesh)
        })
    }

    pub(super) fn grid(&mut self, path: &Path) -> Result<Arc<GridDesc>, String> {
        shared(&mut self.grids, path.to_path_buf(), || grid::vol::read(path))
    }

    /// A picture; `raw` ones are not decoded from sRGB.
    pub(super) fn image(&mut self, path: &Path, raw: bool) -> Result<Arc<ImageDesc>, String> {
        shared(&mut self.images, (path.to_path_buf(), raw), || image::read(path, raw))
    }
}

fn shared<K: std::hash::Hash + Eq, T>(
    known: &mut HashMap<K, Arc<T>>,
    key: K,
    read: impl FnOnce() -> Result<T, FileError>,
) -> Result<Arc<T>, String> {
    if let Some(found) = known.get(&key) {
        return Ok(found.clone());
    }
    let found = Arc::new(read().map_err(|e| e.to_string())?);
    known.insert(key, found.clone());
    Ok(found)
}
