//! Names of the ways in which bidirectional methods find a path.

use super::Merging;

/// A way to find paths of one length. Vertices are counted with the emitter and the lens at the ends of the path, smooth
/// mirrors and glass among them; null boundaries do not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// An edge that joins both walks. No vertices of light: the camera's walk runs into an emitter. One: an emitter is
    /// sampled. One of the camera: light's walk is joined with the lens.
    Join {
        /// Vertices of light's walk.
        light: u32,
        /// Vertices of the camera's walk.
        camera: u32,
    },
    /// Both walks meet in a blur; the vertex where they do belongs to both. A path can be found so at each of its vertices, and
    /// each is a technique of its own.
    Merge {
        /// What is merged.
        merging: Merging,
        /// Vertices of light's walk.
        light: u32,
        /// Vertices of the camera's walk.
        camera: u32,
    },
    /// Paths that are longer than those told apart, however they are found.
    Longer,
}

impl Technique {
    /// Depth of its paths, edges from the emitter to the lens; `None` for those that are longer.
    pub fn depth(self) -> Option<u32> {
        match self {
            Self::Join { light, camera } => Some(light + camera - 1),
            Self::Merge { light, camera, .. } => Some(light + camera - 2),
            Self::Longer => None,
        }
    }
}

/// Short, and fit for files: `d3-s1-t3`, `d2-pp3d-s2-t2`, `longer`.
impl std::fmt::Display for Technique {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Join { light, camera } => write!(f, "d{}-s{light}-t{camera}", light + camera - 1),
            Self::Merge { merging, light, camera } => {
                write!(f, "d{}-{}-s{light}-t{camera}", light + camera - 2, merging.name())
            }
            Self::Longer => f.write_str("longer"),
        }
    }
}

/// The techniques that are told apart, numbered.
#[derive(Clone, Debug)]
pub struct Catalogue {
    max_depth: u32,
    techniques: Vec<Technique>,
    /// Numbers by depth and column: joins by vertices of light, then what is merged, again by vertices of light.
    numbers: Vec<u16>,
}

/// No number.
const NONE: u16 = u16::MAX;

impl Catalogue {
    /// Depths that can be told apart at most.
    pub const MAX_DEPTH: u32 = 32;

    /// The techniques up to `max_depth` (at most [`Catalogue::MAX_DEPTH`]) that are `wanted`, the short ones first.
    pub fn new(max_depth: u32, wanted: impl Fn(Technique) -> bool) -> Self {
        let max_depth = max_depth.min(Self::MAX_DEPTH);
        let mut catalogue = Self { max_depth, techniques: Vec::new(), numbers: Vec::new() };
        let mut number = |technique| {
            if !wanted(technique) {
                return NONE;
            }
            catalogue.techniques.push(technique);
            catalogue.techniques.len() as u16 - 1
        };
        for depth in 1..=max_depth {
            // A lone edge from emitter to lens is only found by the camera's walk.
            let most = if depth == 1 { 0 } else { depth };
            for light in 0..=max_depth {
                let join = (light <= most).then(|| Technique::Join { light, camera: depth + 1 - light });
                catalogue.numbers.push(join.map_or(NONE, &mut number));
            }
            for merging in Merging::ALL {
                for light in 0..=max_depth {
                    let inside = (2..=depth).contains(&light);
                    let merge = inside.then(|| Technique::Merge { merging, light, camera: depth + 2 - light });
                    catalogue.numbers.push(merge.map_or(NONE, &mut number));
                }
            }
        }
        catalogue.numbers.push(number(Technique::Longer));
        catalogue
    }

    /// All of them, by their numbers.
    pub fn techniques(&self) -> &[Technique] {
        &self.techniques
    }

    /// The number of a technique, or of all longer paths; `None` where it is not wanted.
    #[inline]
    pub fn number(&self, technique: Technique) -> Option<usize> {
        let width = self.max_depth as usize + 1;
        let column = match technique {
            Technique::Join { light, .. } => light as usize,
            Technique::Merge { merging, light, .. } => (1 + merging as usize) * width + light as usize,
            Technique::Longer => 0,
        };
        let row = technique.depth().map_or(usize::MAX, |depth| depth as usize - 1);
        let index =
            if row < width - 1 { row * (1 + Merging::ALL.len()) * width + column } else { self.numbers.len() - 1 };
        let number = self.numbers[index];
        (number != NONE).then_some(usize::from(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_technique_has_its_number() {
        for max_depth in [1, 2, 5, 32] {
            let all = Catalogue::new(max_depth, |_| true);
            for (i, technique) in all.techniques().iter().enumerate() {
                assert_eq!(all.number(*technique), Some(i), "{technique}");
            }
            // Depth d > 1: d + 1 joins, and four merges at each of d - 1 vertices.
            let count: u32 = (2..=max_depth).map(|d| d + 1 + 4 * (d - 1)).sum();
            assert_eq!(all.techniques().len() as u32, 1 + count + 1);
        }
    }

    #[test]
    fn names_and_numbers() {
        let no_merges = |technique| !matches!(technique, Technique::Merge { .. });
        let joins = Catalogue::new(3, no_merges);
        let names: Vec<String> = joins.techniques().iter().map(|t| t.to_string()).collect();
        let expected =
            ["d1-s0-t2", "d2-s0-t3", "d2-s1-t2", "d2-s2-t1", "d3-s0-t4", "d3-s1-t3", "d3-s2-t2", "d3-s3-t1", "longer"];
        assert_eq!(names, expected);
        assert_eq!(joins.number(Technique::Join { light: 9, camera: 1 }), Some(8));
        let merge = |light, camera| Technique::Merge { merging: Merging::BeamBeam, light, camera };
        assert_eq!([joins.number(merge(2, 3)), joins.number(merge(2, 4))], [None, Some(8)]);
        assert_eq!(merge(2, 4).to_string(), "d4-bb1d-s2-t4");
    }
}
