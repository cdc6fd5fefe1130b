//! Pages in a browser without a window.

// The browser of the tests of the studio: it stays for the next page, for a start takes several times as much as a page.
#[allow(dead_code, reason = "a page of a run is not used as much as the studio")]
#[path = "../../../../cli/tests/all/studio/browser.rs"]
mod kept;

use std::io::Write;
use std::sync::{Mutex, PoisonError};

use self::kept::{Page, installed};

/// The page after its scripts have run, and what the browser said.
pub fn shown(program: &str, page: &str, name: &str, flags: &[&str]) -> (String, String) {
    let folder = std::env::temp_dir().join(format!("blocksim-report-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("page.html");
    std::fs::write(&file, page).unwrap();
    let out = std::process::Command::new(program)
        .args([
            "--headless",
            "--no-sandbox",
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(flags)
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    (String::from_utf8_lossy(&out.stdout).into_owned(), String::from_utf8_lossy(&out.stderr).into_owned())
}

/// The browser, or the notice that there is none.
pub fn program() -> Option<&'static str> {
    let found = installed();
    if found.is_none() {
        let notice = "SKIPPED: no Chromium is installed; the page was not looked at in a browser";
        let _ = writeln!(std::io::stderr(), "{notice}");
    }
    found
}

/// What the page complained about.
pub fn complaints(said: &str) -> Vec<&str> {
    said.lines().filter(|line| line.contains(":CONSOLE")).collect()
}

/// The page with a script of a test, which runs when the page is ready and whose answer stands in the element
/// `outcome`. The page's own policy would not allow it.
pub fn with_script(page: &str, script: &str) -> String {
    let policy = page.find("<meta http-equiv=\"Content-Security-Policy\"").unwrap();
    let end = policy + page[policy..].find('>').unwrap() + 1;
    format!(
        "{}{}<script>const waiting = setInterval(async () => {{ if (!document.documentElement.dataset.ready) return; \
         clearInterval(waiting); let told; try {{ told = await (async () => {{ {script} }})(); }} catch (error) {{ told = \
         `FAILED ${{error.stack}}`; }} const place = document.createElement('pre'); place.id = 'outcome'; \
         place.textContent = told; document.body.append(place); }}, 10);</script>",
        &page[..policy],
        page[end..].replace("</body>\n</html>\n", "")
    )
}

/// What the script of a test answered in a page of this width and height that had no trouble, if there is a browser.
pub fn answered(page: &str, name: &str, [width, height]: [u32; 2]) -> Option<String> {
    /// One page after the other: a browser has work for all processors, and two of them would have to be started.
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = std::env::temp_dir().join(format!("blocksim-report-{}-{name}", std::process::id()));
    let mut shown = Page::new()?;
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("page.html");
    std::fs::write(&file, page).unwrap();
    shown.size(width, height, 1);
    shown.open(&format!("file://{}", file.display()));
    shown.until("document.getElementById('outcome')");
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(shown.complaints, Vec::<String>::new());
    let trouble = shown.value("document.getElementById('trouble').outerHTML");
    assert_eq!(trouble, "<div id=\"trouble\" role=\"alert\"></div>");
    shown.value("document.getElementById('outcome').textContent").as_str().map(str::to_owned)
}
