//! Pages in a browser without a window.

use std::io::Write;

/// The program of the browser, if one is installed.
fn installed() -> Option<&'static str> {
    let works = |name: &&str| {
        std::process::Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success())
    };
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(works)
}

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
        let required = std::env::var("BLOCKSIM_BROWSER").is_ok_and(|value| value == "required");
        assert!(!required, "no Chromium is installed, and BLOCKSIM_BROWSER=required");
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

/// What the script of a test answered.
pub fn outcome(dom: &str) -> String {
    let text = dom
        .split("<pre id=\"outcome\">")
        .nth(1)
        .and_then(|rest| rest.split("</pre>").next())
        .unwrap_or("none");
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}
