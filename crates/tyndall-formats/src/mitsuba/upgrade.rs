//! Names of versions 0.5 and 0.6 in today's words.

use super::xml::Node;

/// Today's name of a parameter of `plugin`.
pub(crate) fn name(node: &Node, plugin: &str, name: &str) -> String {
    if !node.old {
        return name.into();
    }
    let name = snake_case(name);
    match (node.tag.as_str(), plugin, name.as_str()) {
        ("bsdf", "diffuse", "diffuse_reflectance") => "reflectance".into(),
        ("medium", "heterogeneous", "density") => "sigma_t".into(),
        _ => name,
    }
}

/// `toWorld` to `to_world`, `intIOR` to `int_ior`. Names that start with a capital stay: they are symbols.
fn snake_case(name: &str) -> String {
    if name.starts_with(|c: char| c.is_uppercase()) {
        return name.into();
    }
    let mut out = String::with_capacity(name.len() + 4);
    let mut after_capital = false;
    for c in name.chars() {
        let capital = c.is_uppercase();
        if capital && !after_capital {
            out.push('_');
        }
        after_capital = capital;
        out.extend(c.to_lowercase());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::snake_case;

    #[test]
    fn camel_case_becomes_snake_case() {
        for (old, new) in
            [("toWorld", "to_world"), ("sigmaS", "sigma_s"), ("intIOR", "int_ior"), ("B", "B"), ("g", "g")]
        {
            assert_eq!(snake_case(old), new);
        }
    }
}
