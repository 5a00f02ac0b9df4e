//! The page in a real browser: loaded from disk, driven by mouse, wheel and keys, on a desk and on a phone.
//!
//! Needs ChromeDriver with a Chromium (Debian: `chromium-driver`); says that it was skipped where there is none. Pictures of the
//! window are left in `target/tmp/screenshots`.

mod pyramid;
mod sample;
mod webdriver;

use std::io::Write;
use std::path::{Path, PathBuf};
use webdriver::{Browser, Screen, chromedriver};

/// The page opened from disk, or `None` where there is no browser.
struct Desk {
    browser: Browser,
    folder: tempfile::TempDir,
}

fn shots() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screenshots");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

impl Desk {
    fn open(screen: Screen, page: &str) -> Option<Self> {
        let Some(driver) = chromedriver() else {
            // Past the capture of output: a skipped test has to say so.
            let _ = writeln!(std::io::stderr(), "SKIPPED: no chromedriver found, the page was not tried in a browser");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("index.html"), page).unwrap();
        let desk = Self { browser: Browser::start(&driver, screen, folder.path()), folder };
        desk.go("");
        Some(desk)
    }

    /// Loads the page with a view, and waits until its pictures are there.
    fn go(&self, hash: &str) {
        self.browser.open("about:blank");
        let file = self.folder.path().join("index.html");
        self.browser.open(&format!("file://{}{hash}", file.display()));
        self.settle();
    }

    /// Waits for decoding and for the frame after the next.
    fn settle(&self) {
        self.browser.wait_for("window.tyndall && tyndall.ready()");
        self.browser
            .run("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    }

    fn shot(&self, name: &str) {
        self.settle();
        self.browser.screenshot(&shots().join(format!("{name}.png")));
    }

    /// Colour of the stage at a share of its width and height.
    fn colour(&self, x: f64, y: f64) -> [i64; 3] {
        self.settle();
        let script = format!(
            "const c = document.getElementById('canvas');
             return [...c.getContext('2d').getImageData(c.width * {x}, c.height * {y}, 1, 1).data].slice(0, 3)"
        );
        let found = self.browser.run(&script);
        [0, 1, 2].map(|i| found[i].as_i64().unwrap())
    }

    fn number(&self, expression: &str) -> f64 {
        self.browser.run(&format!("return Number({expression})")).as_f64().unwrap()
    }

    fn text(&self, id: &str) -> String {
        self.browser.run(&format!("return document.getElementById('{id}').textContent")).as_str().unwrap().to_owned()
    }

    /// A point of the window at a share of the stage.
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let script = format!(
            "document.getElementById('stage').scrollIntoView({{ block: 'center', behavior: 'instant' }});
             const b = document.getElementById('stage').getBoundingClientRect();
             return [b.left + b.width * {x}, b.top + b.height * {y}]"
        );
        let found = self.browser.run(&script);
        [0, 1].map(|i| found[i].as_f64().unwrap())
    }

    fn click(&self, id: &str) {
        self.browser.run(&format!("document.getElementById('{id}').click()"));
        self.settle();
    }

    /// A file that the page saved.
    fn saved(&self, name: &str) -> Vec<u8> {
        let file = self.folder.path().join(name);
        for _ in 0..200 {
            if let Ok(bytes) = std::fs::read(&file)
                && !bytes.is_empty()
            {
                return bytes;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        panic!("{name} was not saved");
    }
}

#[test]
fn on_a_desk() {
    let Some(desk) = Desk::open(Screen::Desk, &sample::page()) else { return };
    let browser = &desk.browser;
    assert_eq!(desk.text("title"), "Fog, \"smoke\" & <mirrors>");
    browser.run("document.documentElement.classList.remove('dark')");
    desk.shot("light");
    browser.run("document.documentElement.classList.add('dark')");
    desk.shot("dark");

    // Zoom about the cursor keeps what is under it, and the readout names the pixel there.
    let [x, y] = desk.at(0.7, 0.4);
    browser.point(x, y);
    let before = desk.text("readout");
    browser.wheel(x, y, -600);
    desk.settle();
    assert!(desk.number("tyndall.state.zoom") > 2.0);
    browser.point(x, y);
    assert_eq!(
        desk.text("readout").split(' ').take(4).collect::<Vec<_>>(),
        before.split(' ').take(4).collect::<Vec<_>>()
    );
    desk.shot("zoomed");
    let centre = desk.number("tyndall.state.x");
    browser.drag(&[[x, y], [x - 80.0, y], [x - 120.0, y]]);
    desk.settle();
    assert!(desk.number("tyndall.state.x") > centre);

    // The slider: left of it is A, right of it B, which differ.
    desk.go("#a=biased&b=reference&mode=split&split=0.5");
    let (left, right) = (desk.colour(0.45, 0.5), desk.colour(0.55, 0.5));
    let [x, y] = desk.at(0.5, 0.5);
    browser.drag(&[[x, y], [x + 100.0, y], [x + 200.0, y]]);
    desk.settle();
    assert!(desk.number("tyndall.state.split") > 0.6);
    assert_ne!(desk.colour(0.55, 0.5), right, "now A");
    assert_eq!(desk.colour(0.45, 0.5), left);

    // Exposure by key and by slider, on values beyond what is displayed.
    desk.go("#a=reference&mode=single");
    let bright = desk.colour(0.5, 0.5);
    assert_eq!(bright, sample::shown_centre(0.0));
    browser.keys("eee");
    desk.settle();
    assert_eq!(desk.number("tyndall.state.exposure[0]"), 1.5);
    browser.run("tyndall.state.exposure[0] = -3; tyndall.change()");
    desk.settle();
    assert_eq!(desk.colour(0.5, 0.5), sample::shown_centre(-3.0));

    // Flip by key, and every way to show it.
    desk.go("#a=biased&b=reference&mode=single");
    let a = desk.colour(0.5, 0.5);
    browser.keys(" ");
    desk.settle();
    assert_ne!(desk.colour(0.5, 0.5), a);
    browser.keys(" ");
    assert_eq!(desk.colour(0.5, 0.5), a);
    for name in ["relative", "absolute", "signed", "flip"] {
        browser.keys("d");
        desk.settle();
        assert_eq!(browser.run("return tyndall.state.display"), name);
        desk.shot(&format!("display-{name}"));
    }
    desk.go("#mode=tiles&show=relative&zoom=1");
    desk.shot("tiles");
    desk.go("#mode=single&a=noisy&zoom=40&at=0.5,0.5");
    desk.shot("values");

    // A region is marked with the mouse, shown for all, and saved as PNG.
    desk.go("#mode=single&a=noisy");
    assert!(browser.run("return document.getElementById('insets').hidden") == false, "the report brings an inset");
    browser.keys("i");
    let (from, to) = (desk.at(0.45, 0.4), desk.at(0.55, 0.6));
    browser.drag(&[from, to]);
    desk.settle();
    assert_eq!(desk.number("tyndall.state.insets[0].length"), 2.0);
    desk.click("export");
    let png = desk.saved("ball-in-fog-insets.png");
    assert_eq!(&png[1..4], b"PNG");
    std::fs::write(shots().join("insets-figure.png"), png).unwrap();
    browser.run("document.querySelector('.inset-row .tools button').click()");
    assert_eq!(&desk.saved("ball-in-fog-inset-1.png")[1..4], b"PNG");
    browser.run("document.getElementById('insets').scrollIntoView()");
    desk.shot("insets");
    browser.run("document.getElementById('plot').scrollIntoView()");
    desk.shot("plot");
    browser.run("document.getElementById('figures').scrollIntoView()");
    desk.shot("figures");
    assert!(desk.text("table").contains("failed: exit code 1: error: no such thing"));
    assert!(desk.text("remarks").contains("biased: differs from the reference by more than noise"));

    // The address keeps the view.
    desk.go(
        "#scene=empty+room&mode=tiles&show=absolute&exposure=0,1.5&zoom=3&at=0.25,0.75&error=mape&insets=|2,3,10,12",
    );
    std::thread::sleep(std::time::Duration::from_millis(400));
    for (expression, expected) in [
        ("tyndall.state.scene", 1.0),
        ("tyndall.state.exposure[1]", 1.5),
        ("tyndall.state.zoom", 3.0),
        ("tyndall.state.x", 0.25),
        ("tyndall.state.insets[1][0].height", 12.0),
        ("tyndall.state.insets[0].length", 0.0),
    ] {
        assert_eq!(desk.number(expression), expected, "{expression}");
    }
    desk.go("#scene=nonsense&mode=x&exposure=a,b&zoom=1e99&at=,&insets=9999,0,1,1;a|&split=-4");
    assert_eq!(desk.number("tyndall.state.insets[0].length"), 0.0);
    desk.click("help-open");
    desk.shot("help");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn on_a_phone() {
    let Some(desk) = Desk::open(Screen::Phone, &sample::page()) else { return };
    desk.shot("phone");
    let overflow = desk.number("document.documentElement.scrollWidth - innerWidth");
    assert!(overflow <= 0.0, "the page is {overflow} pixels wider than the screen");
    desk.browser.run("document.getElementById('viewer').scrollIntoView({ behavior: 'instant' })");
    desk.shot("phone-viewer");
    desk.browser.run("document.getElementById('plot').scrollIntoView({ behavior: 'instant' })");
    desk.shot("phone-plot");
    desk.browser.run("document.getElementById('figures').scrollIntoView({ behavior: 'instant' })");
    desk.shot("phone-figures");
    // Two fingers apart.
    desk.at(0.5, 0.5);
    desk.browser.run(
        "const s = document.getElementById('stage'), b = s.getBoundingClientRect();
         s.setPointerCapture = () => {};
         const touch = (type, id, x) => s.dispatchEvent(new PointerEvent(type, { pointerId: id, pointerType: 'touch', bubbles: true,
           clientX: b.left + x, clientY: b.top + b.height / 2 }));
         touch('pointerdown', 11, 150); touch('pointerdown', 12, 250);
         for (let i = 1; i < 6; i++) { touch('pointermove', 11, 150 - 12 * i); touch('pointermove', 12, 250 + 12 * i); }
         touch('pointerup', 11, 90); touch('pointerup', 12, 310);",
    );
    desk.settle();
    assert!(desk.number("tyndall.state.zoom") > 1.5);
    assert_eq!(desk.browser.complaints(), [""; 0]);
}
