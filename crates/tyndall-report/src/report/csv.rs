//! `report.csv`: a row for every render.

use super::{Quantity, Report};

/// The report as comma-separated values with a heading, RFC 4180.
pub fn csv(report: &Report) -> String {
    let fixed = ["scene", "method", "repeat", "seed", "status", "message"];
    let heading = fixed.into_iter().chain(Quantity::ALL.iter().map(|q| q.key()));
    let mut text = heading.collect::<Vec<_>>().join(",") + "\r\n";
    for (scene, method) in report.scenes.iter().flat_map(|scene| scene.methods.iter().map(move |m| (scene, m))) {
        for run in &method.runs {
            let status = if run.failure.is_some() { "failed" } else { "done" };
            let seed = run.seed.map(|seed| seed.to_string()).unwrap_or_default();
            let message = run.failure.as_deref().unwrap_or_default();
            let fixed = [&scene.name, &method.name, &run.repeat.to_string(), &seed, status, message].map(field);
            let figure = |q: &Quantity| run.figures.get(q.key()).map(f64::to_string).unwrap_or_default();
            let row = fixed.into_iter().chain(Quantity::ALL.iter().map(figure));
            text += &(row.collect::<Vec<_>>().join(",") + "\r\n");
        }
    }
    text
}

fn field(text: &str) -> String {
    let plain = !text.contains([',', '"', '\n', '\r']);
    if plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Method, Run, Scene};

    #[test]
    fn rows_and_quotes() {
        let run = |repeat, failure: Option<&str>| Run {
            repeat,
            seed: Some(7),
            failure: failure.map(str::to_owned),
            figures: [("relmse", 0.25)].into(),
            ..Run::default()
        };
        let runs = vec![run(1, None), run(2, Some("exit 1: \"no\",\nreally"))];
        let method = Method { name: "a,b".into(), runs, ..Method::default() };
        let scene = Scene { name: "box".into(), methods: vec![method], ..Scene::default() };
        let text = csv(&Report { scenes: vec![scene], ..Report::default() });
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert!(lines[0].starts_with("scene,method,repeat,seed,status,message,relmse,"));
        assert!(lines[1].starts_with("box,\"a,b\",1,7,done,,0.25,"));
        assert!(lines[2].starts_with("box,\"a,b\",2,7,failed,\"exit 1: \"\"no\"\",\nreally\",0.25,"));
        assert_eq!(lines[0].split(',').count(), 6 + Quantity::ALL.len());
        assert_eq!(lines.len(), 4);
    }
}
