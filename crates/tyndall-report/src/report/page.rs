//! The page: one HTML file with everything inside, which needs neither network nor server.

use super::{Pictures, Report};
use serde::Serialize;
use std::fmt::Write;

const TEMPLATE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/style.css");
/// In the order in which they use each other.
const SCRIPTS: [&str; 10] = [
    include_str!("../page/format.js"),
    include_str!("../page/state.js"),
    include_str!("../page/pictures.js"),
    include_str!("../page/painter.js"),
    include_str!("../page/viewer.js"),
    include_str!("../page/insets.js"),
    include_str!("../page/plot.js"),
    include_str!("../page/tables.js"),
    include_str!("../page/pyramid.js"),
    include_str!("../page/main.js"),
];

/// What a picture's element says about it.
#[derive(Serialize)]
struct Head {
    width: usize,
    height: usize,
    kind: &'static str,
}

/// The page of a report.
pub fn page(report: &Report, pictures: &Pictures) -> String {
    let heads: Vec<Head> = pictures
        .all()
        .iter()
        .map(|picture| Head { width: picture.width, height: picture.height, kind: picture.kind })
        .collect();
    let data = serde_json::json!({ "report": report, "pictures": heads }).to_string();
    let mut elements = format!("<script type=\"application/json\" id=\"data\">{}</script>\n", inside_script(&data));
    for (i, picture) in pictures.all().iter().enumerate() {
        let _ = writeln!(elements, "<script type=\"text/plain\" id=\"picture-{i}\">{}</script>", picture.base64);
    }
    // One scope of its own for all scripts.
    let script = format!("(() => {{\n\"use strict\";\n{}}})();\n", SCRIPTS.concat());
    let parts = [("{{title}}", escape(&report.title)), ("{{style}}", STYLE.into()), ("{{script}}", script)];
    let mut page = TEMPLATE.to_owned();
    for (mark, text) in parts {
        page = page.replacen(mark, &text, 1);
    }
    page.replacen("{{data}}", &elements, 1)
}

/// JSON cannot end the element around it.
fn inside_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_inside() {
        let report = Report { title: "</script><b>".into(), ..Report::default() };
        let mut pictures = Pictures::default();
        pictures.add_map(1, &[0.5]);
        let page = page(&report, &pictures);
        assert!(page.contains("&lt;/script&gt;") && page.contains("\\u003c/script>\\u003cb>"));
        assert!(page.contains("id=\"picture-0\"") && !page.contains("{{"));
        assert_eq!(page.matches("</script>").count(), 3);
        assert!(
            !page.contains("http://") || page.matches("http://").all(|_| page.contains("http://www.w3.org/2000/svg"))
        );
        assert!(page.len() < 2_000_000);
    }
}
