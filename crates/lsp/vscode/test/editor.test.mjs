// The packaged extension in a real editor: code-server, driven in Chromium. Skipped unless EDITOR_TOOLS names a folder with
// `node_modules/code-server` (its parts built) and `node_modules/playwright-core`; CHROMIUM names the browser.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { chmod, mkdir, mkdtemp, rm, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";

const tools = process.env.EDITOR_TOOLS;
const skip = tools ? false : "EDITOR_TOOLS is not set";
const root = fileURLToPath(new URL("../../../../", import.meta.url));
const program = path.resolve(process.env.BLOCKSIM ?? path.join(root, "target/debug/blocksim"));
const vsix = fileURLToPath(new URL("../dist/blocksim.vsix", import.meta.url));
const PATIENCE = 120_000;

const FAULTY = `Diagram(
    simulation: (stop_time: "2 s"),
    parameters: { "gain": 2.0 },
    blocks: {
        "demand": Step(time: "0.1 s", after: "90 deg"),
        "filter": Lowpas(tau: "50 ms"),
        "amplifier": Gain(k: "gian"),
        "show": Scope,
    },
    connections: ["demand.y -> amplifier.u", "amplifier.y -> show.u, shwo.u"],
)
`;

/** A port of this computer that is free. @returns {Promise<number>} */
function freePort() {
    return new Promise((resolve, reject) => {
        const server = createServer();
        server.once("error", reject);
        server.listen(0, "127.0.0.1", () => {
            const { port } = server.address();
            server.close(() => resolve(port));
        });
    });
}

/** Opens a faulty diagram in an editor with this program, and passes the page to `look`. */
async function inEditor(blocksim, look) {
    const require = createRequire(path.join(path.resolve(tools), "of.js"));
    const { chromium } = require("playwright-core");
    const entry = path.join(path.dirname(require.resolve("code-server/package.json")), "out/node/entry.js");
    const folder = await mkdtemp(path.join(tmpdir(), "blocksim-editor-"));
    const at = (name) => path.join(folder, name);
    const env = { ...process.env, HOME: folder, BLOCKSIM_HOME: at("home") };
    await mkdir(at("work"));
    await mkdir(at("data/Machine"), { recursive: true });
    await writeFile(at("work/faulty.ron"), FAULTY);
    await writeFile(at("data/Machine/settings.json"), JSON.stringify({ "blocksim.path": blocksim }));
    const places = ["--user-data-dir", at("data"), "--extensions-dir", at("extensions")];
    const run = (...args) => spawn(process.execPath, [entry, ...places, ...args], { env, stdio: "ignore" });
    const installed = await new Promise((resolve) => run("--install-extension", vsix).once("exit", resolve));
    assert.equal(installed, 0, "the extension is installed");
    const port = await freePort();
    const address = `127.0.0.1:${port}`;
    const quiet = ["--disable-telemetry", "--disable-update-check", "--disable-workspace-trust"];
    const start = () => run("--auth", "none", "--bind-addr", address, ...quiet);
    let server = start();
    let browser;
    try {
        const options = { executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] };
        browser = await chromium.launch(options);
        const page = await browser.newPage();
        page.setDefaultTimeout(PATIENCE);
        const opened = JSON.stringify([["openFile", `vscode-remote://${address}${at("work/faulty.ron")}`]]);
        const url = `http://${address}/?folder=${at("work")}&payload=${encodeURIComponent(opened)}`;
        for (const begin = Date.now(); ; ) {
            try {
                await page.goto(url);
                break;
            } catch (error) {
                if (Date.now() - begin > PATIENCE) throw error;
                // On a busy computer it gives up early.
                if (server.exitCode !== null) server = start();
                await new Promise((resolve) => setTimeout(resolve, 200));
            }
        }
        await page.waitForSelector(".monaco-editor .view-line");
        await look(page);
    } finally {
        await browser?.close();
        const ended = new Promise((resolve) => server.once("exit", resolve));
        if (server.exitCode === null && server.kill()) await ended;
        await rm(folder, { recursive: true, force: true, maxRetries: 5 });
    }
}

test("an editor marks the problems of a diagram", { skip, timeout: 4 * PATIENCE }, async () => {
    await inEditor(program, async (page) => {
        await page.waitForFunction(() => document.querySelectorAll(".squiggly-error").length === 3);
        assert.equal(await page.locator(".notifications-toasts .notification-list-item").count(), 0);
    });
});

test("an editor shows once why there is no language server", { skip, timeout: 4 * PATIENCE }, async () => {
    const folder = await mkdtemp(path.join(tmpdir(), "blocksim-none-"));
    const none = path.join(folder, "blocksim");
    const text = "error[left_out]: cannot serve an editor\n  = help: build it with `--features lsp`\n";
    await writeFile(none, `#!/bin/sh\ncat >&2 <<'END'\n${text}END\nexit 1\n`);
    await chmod(none, 0o755);
    try {
        await inEditor(none, async (page) => {
            const notices = page.locator(".notifications-toasts .notification-list-item");
            await notices.first().waitFor();
            // Others would come soon.
            await page.waitForTimeout(5000);
            const shown = await notices.allInnerTexts();
            assert.equal(shown.length, 1, shown.join("\n"));
            assert.match(shown[0], /cannot serve an editor; build it with `--features lsp`/);
        });
    } finally {
        await rm(folder, { recursive: true, force: true });
    }
});
