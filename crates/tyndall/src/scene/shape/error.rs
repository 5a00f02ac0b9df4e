//! What can be wrong with shapes.

/// A shape that cannot be compiled. Messages name the shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("shape `{shape}`: {problem}")]
pub struct GeometryError {
    /// Name of the shape in its description.
    pub shape: String,
    /// What is wrong with it.
    pub problem: Problem,
}

/// What is wrong with a shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A position, normal or texture coordinate is NaN or infinite, or its transformed position is.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Index in the array.
        index: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// An array has the wrong length.
    #[error("{what}: found {found} values, expected {expected}")]
    WrongLength {
        /// Which array.
        what: String,
        /// Its length.
        found: usize,
        /// The length that fits the mesh.
        expected: usize,
    },
    /// The transform is not affine, not finite or not invertible.
    #[error("`to_world` must be affine, finite and invertible")]
    BadTransform,
    /// A sphere or cylinder would become something else.
    #[error("a {form} can only be scaled by the same factor along all axes; use a mesh")]
    NonUniformScale {
        /// What the shape is.
        form: &'static str,
    },
    /// A radius is not a positive number.
    #[error("radius must be positive and finite, found {0}")]
    BadRadius(f64),
    /// The ends of a cylinder coincide or are not finite.
    #[error("`p0` and `p1` must be finite and different")]
    BadAxis,
    /// An instance inside a shape group.
    #[error("instances cannot be nested in shape groups")]
    NestedInstance,
    /// An instance of a group that does not exist.
    #[error("instance of shape group {0}, which does not exist")]
    UnknownGroup(usize),
    /// An emitter on an instance or inside a shape group.
    #[error("area emitters on instances or in shape groups are not supported")]
    InstancedEmitter,
    /// More surfaces than can be numbered.
    #[error("too many triangles and shapes in one scene or group: the limit is 2^31")]
    TooMany,
}
