//! Tyndall renders participating media: light in fog, smoke, water, juice and skin.
//!
//! Describe a scene (or load one with the crate `tyndall-formats`), build it, render it, take the pixels:
//!
//! ```
//! use tyndall::scene::desc::{EmitterDesc, EmitterKind, GeometryDesc, ShapeDesc};
//! use tyndall::{Budget, Rendering, Scene, SceneDesc, Settings, Transform};
//!
//! let mut desc = SceneDesc::default();
//! (desc.film.width, desc.film.height) = (32, 24);
//! desc.shapes.push(ShapeDesc::new("ball", GeometryDesc::Sphere { center: [0.0, 0.0, 5.0], radius: 1.0 }));
//! desc.emitters.push(EmitterDesc::new("sky", EmitterKind::Constant { radiance: [1.0; 3] }));
//! let scene = Scene::build(&desc)?;
//! let mut rendering = Rendering::new(&scene, &Settings::default())?;
//! rendering.run(Budget::Passes(4), |_, _| std::ops::ControlFlow::Continue(()))?;
//! assert_eq!(rendering.picture().as_slice().len(), 32 * 24 * 3); // linear sRGB, row 0 at the top
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The crate does no input or output, never prints and never exits. Pictures depend on the scene and the seed alone,
//! not on the number of threads.
//!
//! # The rooms
//!
//! Each module may use those before it: [`math`], [`accel`] and [`film`], [`scene`], [`walk`], [`photons`],
//! [`estimators`], [`mis`], [`integrators`], [`render`].

pub mod accel;
pub mod estimators;
pub mod film;
pub mod integrators;
pub mod math;
pub mod mis;
pub mod photons;
pub mod render;
pub mod scene;
mod spectrum;
pub mod walk;

pub use math::Transform;
pub use render::{Budget, Picture, Progress, RenderError, Rendering, Settings};
pub use scene::desc::SceneDesc;
pub use scene::{BuildError, Scene};
pub use spectrum::Spectrum;
