//! A browser without a window that does what a person does: over the pipes of the DevTools protocol
//! (<https://chromedevtools.github.io/devtools-protocol/>), which needs neither a port nor a library.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// How long a page may take for anything.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long a page looks for something before it says that it is not there, ms.
const LOOK: u32 = 500;

/// A browser, and the pipes over which it is spoken with.
struct Browser {
    child: Child,
    to: File,
    from: File,
    read: Vec<u8>,
    asked: u64,
    /// The context and the target of its empty tab, if it has one. That stays, since a window is ten times the work of a page in it.
    empty: Option<(String, String)>,
}

/// Browsers that have nothing to do: a start takes as long as many a test.
static IDLE: Mutex<Vec<Browser>> = Mutex::new(Vec::new());

/// A page of a browser that nobody else uses meanwhile.
pub struct Page {
    /// Until the page is closed.
    browser: Option<Browser>,
    /// Where the page keeps what it remembers.
    context: String,
    session: String,
    /// Tabs of the browser: their targets and sessions.
    tabs: Vec<(String, String)>,
    /// What the page complained about.
    pub complaints: Vec<String>,
}

/// The program of the browser; nothing where none is installed, which is an error if one is required.
pub fn installed() -> Option<&'static str> {
    static FOUND: OnceLock<Option<&'static str>> = OnceLock::new();
    let works =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success());
    // To ask starts the browser.
    let found =
        *FOUND.get_or_init(|| ["chromium", "chromium-browser", "google-chrome"].into_iter().find(works));
    let required = std::env::var("BLOCKSIM_BROWSER").is_ok_and(|value| value == "required");
    assert!(found.is_some() || !required, "no Chromium is installed, and BLOCKSIM_BROWSER=required");
    found
}

impl Browser {
    fn start(program: &str) -> Browser {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("blocksim-browser-{}-{n}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let made = Command::new("mkfifo").arg(folder.join("to")).arg(folder.join("from")).status();
        assert!(made.expect("mkfifo").success());
        // It ends with whoever holds the pipes, and the shell tidies up behind it.
        let child = Command::new("sh")
            .args(["-c", "\"$0\" \"$@\" 3<to 4>from; cd / && rm -rf \"$FOLDER\"", program])
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                // What a person may want and no test looks at: renderers in advance, pages kept to go back to, updates, extensions.
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-default-apps",
                "--disable-extensions",
                "--disable-features=BackForwardCache,OptimizationHints,SpareRendererForSitePerProcess,Translate",
                "--disable-sync",
                "--remote-debugging-pipe",
                "--window-size=1300,900",
            ])
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .env("FOLDER", &folder)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a browser");
        // In the order in which the shell opens them.
        let to = OpenOptions::new().write(true).open(folder.join("to")).expect("a pipe");
        let from = File::open(folder.join("from")).expect("a pipe");
        Browser { child, to, from, read: Vec::new(), asked: 0, empty: None }
    }

    fn message(&mut self) -> Value {
        let mut part = [0; 65_536];
        loop {
            if let Some(end) = self.read.iter().position(|byte| *byte == 0) {
                let message: Vec<u8> = self.read.drain(..=end).collect();
                return serde_json::from_slice(&message[..end]).expect("JSON of the browser");
            }
            let count = self.from.read(&mut part).expect("the browser speaks");
            assert!(count > 0, "the browser has gone");
            self.read.extend_from_slice(&part[..count]);
        }
    }

    /// What it answers, or why it does not; `told` takes what it reports meanwhile.
    fn ask(
        &mut self,
        session: &str,
        method: &str,
        parameters: &Value,
        mut told: impl FnMut(&Value),
    ) -> Result<Value, Value> {
        self.asked += 1;
        let mut request = json!({ "id": self.asked, "method": method, "params": parameters });
        if !session.is_empty() {
            request["sessionId"] = session.into();
        }
        self.to.write_all(format!("{request}\0").as_bytes()).expect("the browser listens");
        loop {
            let mut message = self.message();
            if message["id"] == self.asked {
                let error = message["error"].take();
                return if error.is_null() { Ok(message["result"].take()) } else { Err(error) };
            }
            told(&message);
        }
    }
}

impl Page {
    /// An empty page, if there is a browser.
    pub fn new() -> Option<Page> {
        let idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut browser = match idle.or_else(|| installed().map(Browser::start)) {
            Some(browser) => browser,
            None => {
                let notice = "SKIPPED: no Chromium is installed; the page was not looked at in a browser";
                let _ = writeln!(std::io::stderr(), "{notice}");
                return None;
            }
        };
        let empty = browser.empty.take();
        let (context, session, tabs) = (String::new(), String::new(), Vec::new());
        let mut page = Page { browser: Some(browser), context, session, tabs, complaints: Vec::new() };
        if let Some((context, target)) = empty {
            page.context = context;
            page.attach(target);
        } else {
            let made = page.ask("Target.createBrowserContext", json!({}));
            made["browserContextId"].as_str().expect("a context").clone_into(&mut page.context);
            page.tab();
        }
        Some(page)
    }

    /// Opens one more tab of the browser, and speaks with it from now on.
    pub fn tab(&mut self) {
        self.session.clear();
        let mut new = json!({ "url": "about:blank", "browserContextId": self.context });
        // Further tabs share the window of the first one.
        if self.tabs.is_empty() {
            (new["width"], new["height"]) = (1300.into(), 900.into());
        }
        let made = self.ask("Target.createTarget", new);
        self.attach(made["targetId"].as_str().expect("a target").to_owned());
    }

    fn attach(&mut self, target: String) {
        self.session.clear();
        let attached = self.ask("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        attached["sessionId"].as_str().expect("a session").clone_into(&mut self.session);
        self.tabs.push((target, self.session.clone()));
        for domain in ["Page", "Runtime", "Log"] {
            self.ask(&format!("{domain}.enable"), json!({}));
        }
    }

    /// Runs a script in each page of the present tab before its own.
    pub fn before(&mut self, script: &str) {
        self.ask("Page.addScriptToEvaluateOnNewDocument", json!({ "source": script }));
    }

    /// Looks at another tab, and speaks with it from now on.
    pub fn turn_to(&mut self, tab: usize) {
        self.session.clone_from(&self.tabs[tab].1);
        // Who is not looked at draws nothing.
        self.ask("Page.bringToFront", json!({}));
    }

    /// Closes a tab, and speaks with the first one that is left.
    pub fn close(&mut self, tab: usize) {
        let (target, _) = self.tabs.remove(tab);
        self.session.clear();
        self.ask("Target.closeTarget", json!({ "targetId": target }));
        self.turn_to(0);
    }

    /// How many tabs there are.
    pub fn tabs(&self) -> usize {
        self.tabs.len()
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.answer(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    fn answer(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        let (complaints, tabs) = (&mut self.complaints, &self.tabs);
        let told = |message: &Value| {
            let complains = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"]
                .iter()
                .any(|name| message["method"] == *name);
            // A page that was closed before may have complained last.
            if complains && tabs.iter().any(|(_, session)| message["sessionId"] == *session.as_str()) {
                complaints.push(message["params"].to_string());
            }
        };
        self.browser.as_mut().expect("a browser").ask(&self.session, method, &parameters, told)
    }

    /// Opens an address.
    pub fn open(&mut self, address: &str) {
        self.ask("Page.navigate", json!({ "url": address }));
    }

    /// What an expression of the page gives, as soon as that is anything but null; the page may be on its way.
    fn tried(&mut self, expression: &str) -> Option<Value> {
        let parameters = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut result = self.ask("Runtime.evaluate", parameters);
        result["exceptionDetails"].is_null().then(|| result["result"]["value"].take())
    }

    /// What an expression of the page gives.
    pub fn value(&mut self, expression: &str) -> Value {
        self.tried(expression).unwrap_or_else(|| panic!("{expression} fails; {:?}", self.complaints))
    }

    /// Waits until an expression is true; how long that took.
    pub fn until(&mut self, expression: &str) -> Duration {
        let begin = Instant::now();
        // The page looks itself, for a while: to be asked each time keeps four threads of the browser busy. What fails is not true yet.
        let wait = format!(
            "new Promise((done) => {{ \
               const is = () => {{ try {{ return !!({expression}); }} catch {{ return false; }} }}, end = performance.now() + {LOOK}; \
               const look = () => {{ const now = is(); if (now || performance.now() > end) done(now); else setTimeout(look, 5); }}; \
               look(); \
             }})"
        );
        let parameters = json!({ "expression": wait, "awaitPromise": true, "returnByValue": true });
        loop {
            // A page that goes away answers with an error; the one that comes is asked again.
            let answer = self.answer("Runtime.evaluate", parameters.clone());
            if answer.is_ok_and(|answer| answer["result"]["value"] == true) {
                return begin.elapsed();
            }
            if begin.elapsed() > PATIENCE {
                let text = self.tried("document.body.innerText");
                panic!("`{expression}` does not become true; the page says {text:?}; {:?}", self.complaints);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Presses a key.
    pub fn key(&mut self, key: &str) {
        let code = match key {
            "F5" => 116,
            "Enter" => 13,
            "Escape" => 27,
            "Delete" => 46,
            one => u32::from(one.to_uppercase().as_bytes()[0]),
        };
        let text = if key.chars().count() == 1 {
            json!(key)
        } else if key == "Enter" {
            json!("\r")
        } else {
            json!(null)
        };
        for kind in ["keyDown", "keyUp"] {
            let mut event = json!({ "type": kind, "key": key, "windowsVirtualKeyCode": code });
            if kind == "keyDown" && !text.is_null() {
                event["text"] = text.clone();
            }
            self.ask("Input.dispatchKeyEvent", event);
        }
    }

    /// Presses a key that writes nothing, such as Home.
    pub fn press(&mut self, key: &str, code: &str) {
        let number = match key {
            "End" => 35,
            "Home" => 36,
            _ => 0,
        };
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({ "type": kind, "key": key, "code": code, "windowsVirtualKeyCode": number });
            self.ask("Input.dispatchKeyEvent", event);
        }
    }

    /// Presses a key with Alt (1), Ctrl (2), Shift (8), or several of them.
    pub fn chord(&mut self, key: &str, modifiers: u32) {
        let number = match key {
            "Tab" => 9,
            "Enter" => 13,
            one if one.len() == 1 => u32::from(one.to_uppercase().as_bytes()[0]),
            _ => 0,
        };
        for kind in ["rawKeyDown", "keyUp"] {
            let event =
                json!({ "type": kind, "key": key, "windowsVirtualKeyCode": number, "modifiers": modifiers });
            self.ask("Input.dispatchKeyEvent", event);
        }
    }

    /// Draws the mouse from one point to another with its button pressed; `lets_go` there, or holds it.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2], lets_go: bool) {
        const STEPS: u32 = 4;
        let mut event = |kind: &str, [x, y]: [f64; 2], buttons: u32| {
            let button = if kind == "mouseMoved" { "none" } else { "left" };
            let event = json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
            self.ask("Input.dispatchMouseEvent", event);
        };
        event("mouseMoved", from, 0);
        event("mousePressed", from, 1);
        for n in 1..=STEPS {
            let share = f64::from(n) / f64::from(STEPS);
            event("mouseMoved", [0, 1].map(|k| from[k] + share * (to[k] - from[k])), 1);
        }
        if lets_go {
            event("mouseReleased", to, 0);
        }
    }

    /// Draws a finger from one point to another.
    pub fn swipe(&mut self, from: [f64; 2], to: [f64; 2]) {
        // The first move only tells the browser that it is no tap.
        let between = [0, 1].map(|k| 0.5 * (from[k] + to[k]));
        let moves = [("touchStart", vec![from]), ("touchMove", vec![between]), ("touchMove", vec![to])];
        for (kind, points) in moves.into_iter().chain([("touchEnd", vec![])]) {
            let points: Vec<Value> = points.iter().map(|[x, y]| json!({ "x": x, "y": y })).collect();
            self.ask("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }));
            // Fingers are followed from picture to picture.
            self.drawn();
        }
    }

    /// Waits until what has changed is drawn.
    pub fn drawn(&mut self) {
        self.value(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))",
        );
    }

    /// The page as wide and high as this, of dots that are so many times as large.
    pub fn size(&mut self, width: u32, height: u32, scale: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": scale, "mobile": false });
        self.ask("Emulation.setDeviceMetricsOverride", size);
    }

    /// What the page is for those who do not see it: all nodes of its accessibility tree.
    pub fn tree(&mut self) -> Vec<Value> {
        let mut tree = self.ask("Accessibility.getFullAXTree", json!({}));
        tree["nodes"].as_array_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Types text where the focus is, in the place of what is there.
    pub fn replace(&mut self, text: &str) {
        self.value("document.activeElement.select()");
        self.ask("Input.insertText", json!({ "text": text }));
    }

    /// Types text where the cursor is.
    pub fn insert(&mut self, text: &str) {
        self.ask("Input.insertText", json!({ "text": text }));
    }

    /// Presses a key together with Ctrl.
    pub fn control(&mut self, key: &str) {
        let code = u32::from(key.to_uppercase().as_bytes()[0]);
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({ "type": kind, "key": key, "windowsVirtualKeyCode": code, "modifiers": 2 });
            self.ask("Input.dispatchKeyEvent", event);
        }
    }

    /// Clicks the middle of what a selector finds.
    pub fn click(&mut self, selector: &str) {
        let place = format!(
            "(() => {{ const at = document.querySelector({}).getBoundingClientRect(); return [at.x + at.width / 2, at.y + at.height / 2]; }})()",
            json!(selector)
        );
        let at = self.value(&place);
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": at[0], "y": at[1], "button": "left", "clickCount": 1 });
            self.ask("Input.dispatchMouseEvent", event);
        }
    }

    /// A picture of the page (WebP).
    pub fn picture(&mut self) -> Vec<u8> {
        let how = json!({ "format": "webp", "quality": 80 });
        let picture = self.ask("Page.captureScreenshot", how)["data"].take();
        STANDARD.decode(picture.as_str().unwrap_or_default()).expect("base64")
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // One in which something went wrong may be in the middle of an answer.
        if std::thread::panicking() {
            if let Some(mut browser) = self.browser.take() {
                let _ = browser.child.kill();
            }
            return;
        }
        // The next page finds a tab as if it were new: of the same size, with nothing in its stores, and without what was set for the
        // session.
        while self.tabs.len() > 1 {
            self.close(1);
        }
        self.turn_to(0);
        self.tried(
            "addEventListener('beforeunload', (event) => event.stopImmediatePropagation(), true); \
             localStorage.clear(); sessionStorage.clear()",
        );
        self.open("about:blank");
        self.until("location.href === 'about:blank'");
        let (target, session) = self.tabs.remove(0);
        self.session.clear();
        self.ask("Storage.clearCookies", json!({ "browserContextId": self.context }));
        self.ask("Target.detachFromTarget", json!({ "sessionId": session }));
        let Some(mut browser) = self.browser.take() else { return };
        browser.empty = Some((std::mem::take(&mut self.context), target));
        IDLE.lock().unwrap_or_else(PoisonError::into_inner).push(browser);
    }
}
