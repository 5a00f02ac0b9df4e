//! The page of a pyramid of techniques.

use super::Desk;
use super::webdriver::Screen;
use tyndall::mis::{Merging, Technique};
use tyndall::render::TechniquePicture;
use tyndall_report::View;
use tyndall_report::report::{PyramidPage, Report};

const WIDTH: usize = 32;

/// Grey pictures: every technique adds 0.01 times its number, and would show 0.5 alone.
fn page() -> String {
    let grey = |value: f32| vec![[value; 3]; WIDTH * 24];
    let join = |light, camera| Technique::Join { light, camera };
    let merge = |merging, light, camera| Technique::Merge { merging, light, camera };
    let mut techniques = vec![join(0, 2)];
    for depth in 2..=4 {
        techniques.extend((0..=depth).map(|light| join(light, depth + 1 - light)));
        for merging in [Merging::BeamPoint, Merging::BeamBeam] {
            techniques.extend((2..=depth).map(|light| merge(merging, light, depth + 2 - light)));
        }
    }
    techniques.push(Technique::Longer);
    let report = Report {
        title: "ball: the pyramid of upbp".into(),
        budget: "32 × 24 pixels".into(),
        command: "tyndall render ball.xml -i upbp --pyramid out".into(),
        ..Report::default()
    };
    let whole = grey(0.01 * (1..=techniques.len()).sum::<usize>() as f32);
    let view = View::new(WIDTH, 24, &whole).unwrap();
    let mut page = PyramidPage::new(report, view, techniques.len());
    for (i, technique) in techniques.into_iter().enumerate() {
        page.add(WIDTH, &TechniquePicture { technique, weighted: grey(0.01 * (i + 1) as f32), alone: grey(0.5) });
    }
    page.finish()
}

impl Desk {
    /// Brightness in the middle of the picture of a technique in the grid, sRGB.
    fn grey_of(&self, name: &str) -> f64 {
        self.settle();
        self.number(&format!(
            "(() => {{ const c = document.querySelector('.pyramid [aria-label^=\"{name}:\"] canvas');
             return c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1).data[1]; }})()"
        ))
    }
}

fn encoded(value: f64) -> f64 {
    255.0 * (1.055 * value.min(1.0).powf(1.0 / 2.4) - 0.055)
}

#[test]
fn techniques_are_shown_as_pyramids() {
    let Some(desk) = Desk::open(Screen::Desk, &page()) else { return };
    let browser = &desk.browser;
    desk.go("#exposure=0,0");
    assert_eq!(desk.number("document.querySelectorAll('.pyramid').length"), 3.0);
    // All of them, one for all longer paths and the picture.
    assert_eq!(desk.number("document.querySelectorAll('.pyramid button').length"), 1.0 + 12.0 + 12.0 + 2.0);
    // Rows are centred below each other.
    let skew = "(() => { const rows = [...document.querySelectorAll('.pyramid:first-child .line')].map((line) => {
        const b = [...line.querySelectorAll('button')].map((x) => x.getBoundingClientRect());
        return (b[0].left + b.at(-1).right) / 2; });
        return Math.max(...rows) - Math.min(...rows); })()";
    assert!(desk.number(skew) < 1.0);
    // The fourth technique adds 0.04.
    assert!((desk.grey_of("d2-s2-t1") - encoded(0.04)).abs() < 1.0);
    desk.shot("pyramid");
    browser.keys("u");
    assert!((desk.grey_of("d2-s2-t1") - encoded(0.5)).abs() < 1.0, "unweighted");
    assert_eq!(desk.number("tyndall.state.scene"), 1.0);
    let longer = "document.querySelector('.pyramid [aria-label^=\"longer:\"]').hidden";
    assert_eq!(desk.number(longer), 1.0, "techniques taken together have no unweighted picture");
    browser.keys("e");
    assert!((desk.grey_of("d2-s2-t1") - encoded(0.5 * 2f64.sqrt())).abs() < 1.0);
    browser.keys("u");
    assert!((desk.grey_of("d2-s2-t1") - encoded(0.04 * 2f64.sqrt())).abs() < 1.0, "both have one exposure");
    browser.keys("g");
    assert!((desk.grey_of("d2-s2-t1") - encoded(0.9)).abs() < 6.0, "its own exposure");
    assert!((desk.grey_of("longer") - encoded(0.9)).abs() < 6.0);
    desk.shot("pyramid-own");
    // Arrows go from picture to picture: right, then down to the row of depth 3.
    browser.run("document.querySelector('.pyramid [aria-label^=\"d2-s1-t2:\"]').focus()");
    browser.keys("\u{e014}");
    desk.settle();
    assert_eq!(browser.run("return tyndall.entries()[tyndall.state.a]"), "d2-s2-t1");
    browser.keys("\u{e015}");
    desk.settle();
    let found = browser.run("return tyndall.entries()[tyndall.state.a]");
    assert!(found == "d3-s2-t2" || found == "d3-s3-t1", "{found}");
    // The address keeps it.
    desk.go("#scene=unweighted&even=1&a=d3-bb1d-s2-t3");
    assert_eq!(desk.number("tyndall.state.scene + 2 * tyndall.state.even"), 3.0);
    assert_eq!(browser.run("return tyndall.entries()[tyndall.state.a]"), "d3-bb1d-s2-t3");
    browser.run("document.documentElement.classList.toggle('dark')");
    desk.shot("pyramid-dark");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn techniques_on_a_phone() {
    let Some(desk) = Desk::open(Screen::Phone, &page()) else { return };
    let overflow = desk.number("document.documentElement.scrollWidth - innerWidth");
    assert!(overflow <= 0.0, "the page is {overflow} pixels wider than the screen");
    desk.shot("pyramid-phone");
    assert_eq!(desk.browser.complaints(), [""; 0]);
}
