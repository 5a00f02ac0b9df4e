//! Agreement with Mitsuba 3.9.1, whose numbers for the same cases are in `mitsuba.tsv`.

use super::*;

/// One line of the table.
struct Row {
    what: String,
    case: String,
    transport: Transport,
    wo: Vec3,
    wi: Vec3,
    value: [f32; 3],
    /// The density, or the first random number of a delta sample.
    number: f32,
}

fn rows() -> impl Iterator<Item = Row> {
    let lines = include_str!("mitsuba.tsv").lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| {
        let columns: Vec<&str> = line.split('\t').collect();
        let numbers = |i: usize| -> [f32; 3] {
            let parsed: Vec<f32> = columns[i].split(' ').map(|x| x.parse().unwrap()).collect();
            parsed.try_into().unwrap()
        };
        Row {
            what: columns[0].into(),
            case: columns[1].into(),
            transport: if columns[2] == "R" { Transport::Radiance } else { Transport::Importance },
            wo: numbers(3).into(),
            wi: numbers(4).into(),
            value: numbers(5),
            number: columns[6].parse().unwrap(),
        }
    })
}

fn near(found: f32, expected: f32) -> bool {
    (found - expected).abs() <= 1e-4 * expected.abs() + 1e-6
}

#[test]
fn values_densities_and_specular_samples() {
    let mut wrong = Vec::new();
    let mut seen = 0;
    let mut probe = (String::new(), Probe::named("diffuse"));
    for row in rows() {
        if probe.0 != row.case {
            probe = (row.case.clone(), Probe::named(&row.case));
        }
        let probe = &probe.1;
        let (value, rest) = match row.what.as_str() {
            "eval" => {
                let (value, pdf) = probe.eval(row.wo, row.wi, row.transport);
                (value, near(pdf, row.number))
            }
            "delta" => {
                let s = probe.sample(row.wo, row.transport, row.number, Vec2::new(0.3, 0.7)).unwrap();
                (s.weight, s.event.delta && s.pdf.0 == 0.0 && (s.wi - row.wi).length() < 1e-5)
            }
            "null" => (probe.bsdfs.null_transmission(probe.root, &probe.context(), row.wo), true),
            other => panic!("{other}"),
        };
        seen += 1;
        let value = value.to_rgb();
        if !(rest && value.iter().zip(row.value).all(|(&a, b)| near(a, b))) {
            let pdf = probe.eval(row.wo, row.wi, row.transport).1;
            wrong.push(format!(
                "{} {} {:?} wo {} wi {}: {value:?} {pdf}, expected {:?} {}",
                row.what, row.case, row.transport, row.wo, row.wi, row.value, row.number
            ));
        }
    }
    assert!(seen > 300, "{seen} rows");
    assert!(wrong.is_empty(), "{} of {seen} rows differ:\n{}", wrong.len(), wrong.join("\n"));
}
