//! The LaTeX table of a report, for booktabs.

use super::{Method, Quantity, Report, Scene};

/// Columns beside the method's name.
const COLUMNS: [Quantity; 6] =
    [Quantity::RelMse, Quantity::Flip, Quantity::Seconds, Quantity::Samples, Quantity::Memory, Quantity::Efficiency];

/// A `tabular`: a block of rows for every scene, the best figures bold, spreads below the medians' sizes.
pub fn latex(report: &Report) -> String {
    let heading = |q: &Quantity| {
        let description = q.describe();
        let unit = match description.unit {
            "" => String::new(),
            "B" => " [MB]".into(),
            unit => format!(" [{unit}]"),
        };
        format!("{}{}", escape(description.label), escape(&unit))
    };
    let mut text = format!("% {}\n% Needs \\usepackage{{booktabs}}.\n", report.command.replace('\n', " "));
    text += &format!("\\begin{{tabular}}{{l{}}}\n\\toprule\n", "r".repeat(COLUMNS.len()));
    text += &format!("method & {} \\\\\n", COLUMNS.iter().map(heading).collect::<Vec<_>>().join(" & "));
    for scene in &report.scenes {
        let columns = COLUMNS.len() + 1;
        text += &format!("\\midrule\n\\multicolumn{{{columns}}}{{l}}{{\\emph{{{}}}}} \\\\\n", escape(&scene.name));
        for method in &scene.methods {
            let cells = match &method.failure {
                Some(_) => format!("\\multicolumn{{{}}}{{l}}{{failed}}", COLUMNS.len()),
                None => COLUMNS.iter().map(|q| cell(scene, method, *q)).collect::<Vec<_>>().join(" & "),
            };
            let flag = if method.split.is_some_and(|s| s.significant) { "$^{\\ast}$" } else { "" };
            text += &format!("{}{flag} & {cells} \\\\\n", escape(&method.name));
        }
    }
    text += "\\bottomrule\n\\end{tabular}\n";
    let flagged = report.scenes.iter().flat_map(|s| &s.methods).any(|m| m.split.is_some_and(|s| s.significant));
    if flagged {
        text += "% $^{\\ast}$ differs from the reference by more than noise: biased, or not all light was found.\n";
    }
    text
}

fn cell(scene: &Scene, method: &Method, quantity: Quantity) -> String {
    let figure = |m: &Method| m.figures.get(quantity.key()).map(|f| f.median);
    let Some(found) = method.figures.get(quantity.key()) else {
        return "--".into();
    };
    let all = scene.methods.iter().filter_map(figure);
    let best = match quantity.describe().better {
        Some("low") => all.fold(f64::INFINITY, f64::min),
        Some(_) => all.fold(f64::NEG_INFINITY, f64::max),
        None => f64::NAN,
    };
    let scale = if quantity == Quantity::Memory { 1e-6 } else { 1.0 };
    let number = number(found.median * scale);
    let number = if found.median == best { format!("\\textbf{{{number}}}") } else { number };
    let spread = 0.5 * (found.high - found.low) / found.median.abs().max(f64::MIN_POSITIVE) * 100.0;
    if found.values.len() > 1 && spread >= 0.5 {
        format!("{number} {{\\scriptsize$\\pm${spread:.0}\\,\\%}}")
    } else {
        number
    }
}

/// Three digits.
fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let exponent = x.abs().log10().floor() as i32;
    match exponent {
        -3..=2 => format!("{x:.*}", (2 - exponent) as usize),
        3..=4 => format!("{x:.0}"),
        _ => format!("${:.2}\\cdot10^{{{exponent}}}$", x / 10f64.powi(exponent)),
    }
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' => escaped += "\\textbackslash{}",
            '~' => escaped += "\\textasciitilde{}",
            '^' => escaped += "\\textasciicircum{}",
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', c]),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::Figure;

    #[test]
    fn a_table() {
        let method = |name: &str, relmse: &[f64]| Method {
            name: name.into(),
            figures: [("relmse", Figure::new(relmse.to_vec()).unwrap())].into(),
            ..Method::default()
        };
        let failed = Method { name: "x".into(), failure: Some("crashed".into()), ..Method::default() };
        let methods = vec![method("a_1", &[0.01, 0.02, 0.03]), method("b", &[0.5]), failed];
        let scene = Scene { name: "50 % fog".into(), methods, ..Scene::default() };
        let text = latex(&Report { scenes: vec![scene], ..Report::default() });
        assert!(text.contains("50 \\% fog"));
        assert!(text.contains("a\\_1 & \\textbf{0.0200} {\\scriptsize$\\pm$50\\,\\%} & -- "), "{text}");
        assert!(text.contains("b & 0.500 & --"));
        assert!(text.contains("x & \\multicolumn{6}{l}{failed} \\\\"));
    }

    #[test]
    fn numbers() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(123.4), "123");
        assert_eq!(number(1.234), "1.23");
        assert_eq!(number(12345.6), "12346");
        assert_eq!(number(1.5e-7), "$1.50\\cdot10^{-7}$");
    }
}
