//! As much of WebDriver (W3C, 2018) as the test needs, over HTTP to a ChromeDriver of its own.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

/// The program that drives the browser: named by `TYNDALL_CHROMEDRIVER`, or found in the path.
pub fn chromedriver() -> Option<PathBuf> {
    if let Some(given) = std::env::var_os("TYNDALL_CHROMEDRIVER") {
        return Some(given.into());
    }
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join("chromedriver")).find(|file| file.is_file())
}

/// A browser with one window.
pub struct Browser {
    driver: Child,
    session: String,
    agent: ureq::Agent,
    /// Kept open: the driver would end when it cannot write.
    _said: BufReader<ChildStdout>,
}

/// A window of a desk or a phone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Screen {
    Desk,
    Phone,
}

impl Browser {
    /// Starts driver and browser. Files that the page saves come into `downloads`.
    pub fn start(driver: &Path, screen: Screen, downloads: &Path) -> Self {
        let mut child =
            Command::new(driver).arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        let port = loop {
            let mut line = String::new();
            assert!(said.read_line(&mut line).unwrap() > 0, "ChromeDriver ended before it started");
            if let Some((_, port)) = line.split_once("started successfully on port ") {
                break port.trim().trim_end_matches('.').to_owned();
            }
        };
        // Pages that do something wrong answer with an error status and a message in the body.
        let agent = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).build().new_agent();
        let mut browser =
            Self { driver: child, session: format!("http://127.0.0.1:{port}/session"), agent, _said: said };
        let mut options = json!({
            "args": [
                "--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
                "--disable-sync", "--disable-dev-shm-usage", "--window-size=1400,1000",
            ],
            "prefs": { "download.default_directory": downloads, "download.prompt_for_download": false,
                "profile.default_content_setting_values.automatic_downloads": 1 },
        });
        if screen == Screen::Phone {
            options["mobileEmulation"] =
                json!({ "deviceMetrics": { "width": 390, "height": 844, "pixelRatio": 2.0, "touch": true } });
        }
        let wanted = json!({ "goog:chromeOptions": options, "goog:loggingPrefs": { "browser": "ALL" } });
        let answer = browser.post("", json!({ "capabilities": { "alwaysMatch": wanted } }));
        browser.session = format!("{}/{}", browser.session, answer["sessionId"].as_str().expect("a session"));
        browser
    }

    fn post(&self, path: &str, body: Value) -> Value {
        let mut answer = self.agent.post(format!("{}{path}", self.session)).send_json(body).unwrap();
        let text = answer.body_mut().with_config().limit(1 << 28).read_to_string().unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        assert!(answer.status().is_success(), "{path}: {}", value["value"]["message"]);
        value["value"].clone()
    }

    /// Loads a page.
    pub fn open(&self, address: &str) {
        self.post("/url", json!({ "url": address }));
    }

    /// Runs a function's body in the page; what it returns.
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", json!({ "script": script, "args": [] }))
    }

    /// Waits until an expression is true.
    pub fn wait_for(&self, expression: &str) {
        for _ in 0..600 {
            if self.run(&format!("return Boolean({expression})")) == Value::Bool(true) {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        panic!("still not true: {expression}");
    }

    /// A picture of the window.
    pub fn screenshot(&self, file: &Path) {
        use base64::Engine;
        let mut answer = self.agent.get(format!("{}/screenshot", self.session)).call().unwrap();
        let text = answer.body_mut().with_config().limit(1 << 28).read_to_string().unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(value["value"].as_str().unwrap()).unwrap();
        std::fs::write(file, bytes).unwrap();
    }

    /// Presses keys one after the other, wherever the focus is.
    pub fn keys(&self, keys: &str) {
        let press = |key: char| [json!({ "type": "keyDown", "value": key }), json!({ "type": "keyUp", "value": key })];
        let actions: Vec<Value> = keys.chars().flat_map(press).collect();
        self.post("/actions", json!({ "actions": [{ "type": "key", "id": "keys", "actions": actions }] }));
    }

    /// Drags with the mouse through points of the window.
    pub fn drag(&self, points: &[[f64; 2]]) {
        let move_to = |p: &[f64; 2]| json!({ "type": "pointerMove", "duration": 60, "x": p[0] as i64, "y": p[1] as i64, "origin": "viewport" });
        let mut actions = vec![move_to(&points[0]), json!({ "type": "pointerDown", "button": 0 })];
        actions.extend(points[1..].iter().map(move_to));
        actions.push(json!({ "type": "pointerUp", "button": 0 }));
        let mouse = json!({ "type": "pointer", "id": "mouse", "actions": actions });
        self.post("/actions", json!({ "actions": [mouse] }));
    }

    /// Moves the mouse.
    pub fn point(&self, x: f64, y: f64) {
        let action =
            json!({ "type": "pointerMove", "duration": 20, "x": x as i64, "y": y as i64, "origin": "viewport" });
        let mouse = json!({ "type": "pointer", "id": "mouse", "actions": [action] });
        self.post("/actions", json!({ "actions": [mouse] }));
    }

    /// Turns the wheel over a point.
    pub fn wheel(&self, x: f64, y: f64, by: i64) {
        let action =
            json!({ "type": "scroll", "duration": 0, "x": x as i64, "y": y as i64, "deltaX": 0, "deltaY": by });
        self.post("/actions", json!({ "actions": [{ "type": "wheel", "id": "wheel", "actions": [action] }] }));
    }

    /// What the page complained about since the last question; that this test reads back its canvas is not its fault.
    pub fn complaints(&self) -> Vec<String> {
        let entries = self.post("/se/log", json!({ "type": "browser" }));
        let entries = entries.as_array().cloned().unwrap_or_default();
        entries
            .iter()
            .filter(|e| e["level"] != "INFO" && e["level"] != "DEBUG")
            .map(|e| e["message"].to_string())
            .filter(|message| !message.contains("willReadFrequently"))
            .collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ends the browser; without that it would outlive its driver.
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
