// @ts-check
"use strict";

const { execFile } = require("node:child_process");
const fs = require("node:fs/promises");
const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { CloseAction, LanguageClient } = require("vscode-languageclient/node");
const { commandLines, drawing } = require("./commands");
const { notice, startServer } = require("./server");

/** @type {LanguageClient | undefined} */
let client;

/** A client that shows no errors of its own before the server has run once: `start` shows the reason, which the client lacks. */
class Client extends LanguageClient {
    hasRun = false;

    error(/** @type {string} */ message, /** @type {any} */ data, /** @type {boolean | "force" | undefined} */ show) {
        super.error(message, data, this.hasRun ? show : false);
    }
}

function program() {
    return vscode.workspace.getConfiguration("blocksim").get("path", "blocksim");
}

function firstFolder() {
    return vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
}

async function start() {
    // The server is started before its client, which would hide why that fails.
    /** @type {Awaited<ReturnType<typeof startServer>> | undefined} */
    let first;
    try {
        first = await startServer(program(), firstFolder());
    } catch (error) {
        showFailure(error instanceof Error ? error.message : String(error));
        return;
    }
    const { ended } = first;
    const server = async () => {
        const started = first ?? (await startServer(program(), firstFolder()));
        first = undefined;
        return started.server;
    };
    const starting = new Client("blocksim", "blocksim", server, {
        documentSelector: [{ scheme: "file", language: "ron" }],
        // Files that another program writes may belong to an open model.
        synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{ron,csv}") },
        initializationFailedHandler: () => false,
        errorHandler: {
            error: (error, message, count) => restarts.error(error, message, count),
            // Before it has run, a server that ends would end again.
            closed: () => (starting.hasRun ? restarts.closed() : { action: CloseAction.DoNotRestart, handled: true }),
        },
    });
    const restarts = starting.createDefaultErrorHandler();
    client = starting;
    // What the server prints explains more than what the client notices first, such as a broken pipe.
    const early = ended.then((errors) => {
        throw new Error(notice(errors) || "it ended at once");
    });
    const started = starting.start().catch((error) => Promise.race([early, rejectLater(error)]));
    try {
        await Promise.race([started, early]);
        starting.hasRun = true;
    } catch (error) {
        // A client that has been replaced or stopped meanwhile has nothing to report.
        if (client === starting) {
            client = undefined;
            showFailure(error instanceof Error ? error.message : String(error));
        }
    }
}

/** @param {unknown} error */
function rejectLater(error) {
    return new Promise((_, reject) => setTimeout(reject, 2000, error));
}

/** Shows why there is no language server. @param {string} reason */
function showFailure(reason) {
    const settings = "Open Settings";
    const text = `The language server \`${program()} lsp\` does not start: ${reason}. The setting \`blocksim.path\` names the program.`;
    // Not awaited: the commands work without the server.
    vscode.window.showErrorMessage(text, settings).then((chosen) => {
        if (chosen === settings) {
            vscode.commands.executeCommand("workbench.action.openSettings", "blocksim.path");
        }
    });
}

async function stop() {
    const running = client;
    client = undefined;
    await running?.stop();
}

/** The diagram in the active editor, saved. */
async function activeDiagram() {
    const document = vscode.window.activeTextEditor?.document;
    if (!document || document.uri.scheme !== "file" || document.languageId !== "ron") {
        vscode.window.showWarningMessage("Open a diagram (.ron) first.");
        return undefined;
    }
    // The program reads files: what is not on the disk does not count for it.
    if (document.isDirty && !(await document.save())) {
        return undefined;
    }
    return document;
}

/** @param {vscode.TextDocument | undefined} document */
function folderOf(document) {
    const folder = document && vscode.workspace.getWorkspaceFolder(document.uri);
    return folder?.uri.fsPath ?? (document ? path.dirname(document.uri.fsPath) : firstFolder());
}

/** Runs the program in a terminal, so that its output and colours are seen and it can be stopped. */
async function runTask(/** @type {string} */ name) {
    const isOfFile = name !== "blocksim.report";
    const document = isOfFile ? await activeDiagram() : vscode.window.activeTextEditor?.document;
    if (isOfFile && !document) {
        return;
    }
    const args = commandLines[name](document?.uri.fsPath ?? "");
    const execution = new vscode.ProcessExecution(program(), args, { cwd: folderOf(document) });
    const definition = { type: "blocksim", command: name };
    const title = `blocksim ${args[0]}`;
    const task = new vscode.Task(definition, vscode.TaskScope.Workspace, title, "blocksim", execution, []);
    task.presentationOptions = { clear: true, focus: false, panel: vscode.TaskPanelKind.Dedicated };
    await vscode.tasks.executeTask(task);
}

/** @type {Map<string, vscode.WebviewPanel>} */
const drawings = new Map();

/** Draws a diagram beside its text; again whenever it is saved. */
async function draw() {
    const document = await activeDiagram();
    if (!document) {
        return;
    }
    const file = document.uri.fsPath;
    let panel = drawings.get(file);
    if (!panel) {
        const title = `Drawing of ${path.basename(file)}`;
        const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
        panel = vscode.window.createWebviewPanel("blocksim.drawing", title, place, {});
        drawings.set(file, panel);
        panel.onDidDispose(() => drawings.delete(file));
    }
    panel.reveal(undefined, true);
    await redraw(file, panel);
}

async function redraw(/** @type {string} */ file, /** @type {vscode.WebviewPanel} */ panel) {
    const kind = vscode.window.activeColorTheme.kind;
    const isDark = kind === vscode.ColorThemeKind.Dark || kind === vscode.ColorThemeKind.HighContrast;
    const folder = await fs.mkdtemp(path.join(os.tmpdir(), "blocksim-"));
    const svg = path.join(folder, "drawing.svg");
    try {
        const output = await new Promise((resolve) => {
            const options = { cwd: path.dirname(file), timeout: 60_000 };
            execFile(program(), drawing(file, svg, isDark), options, (error, _stdout, stderr) =>
                resolve(stderr || error?.message || ""),
            );
        });
        const text = await fs.readFile(svg, "utf8").catch(() => "");
        const content = text ? text.slice(Math.max(text.indexOf("<svg"), 0)) : `<pre>${escaped(output)}</pre>`;
        panel.webview.html = page(content);
    } finally {
        await fs.rm(folder, { recursive: true, force: true });
    }
}

/** @param {string} text */
function escaped(text) {
    return text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
}

/** A page that runs no script and loads nothing, whatever the drawing holds. @param {string} content */
function page(content) {
    const policy = "default-src 'none'; style-src 'unsafe-inline'";
    return `<!doctype html><meta http-equiv="Content-Security-Policy" content="${policy}">
<style>svg { max-width: 100%; height: auto } pre { white-space: pre-wrap }</style>${content}`;
}

/** @param {vscode.ExtensionContext} context */
async function activate(context) {
    const register = (/** @type {string} */ name, /** @type {() => unknown} */ action) =>
        context.subscriptions.push(vscode.commands.registerCommand(name, action));
    Object.keys(commandLines).forEach((name) => register(name, () => runTask(name)));
    register("blocksim.draw", draw);
    register("blocksim.restart", async () => {
        await stop();
        await start();
    });
    context.subscriptions.push(
        vscode.workspace.onDidSaveTextDocument((document) => {
            const panel = drawings.get(document.uri.fsPath);
            return panel && redraw(document.uri.fsPath, panel);
        }),
        vscode.workspace.onDidChangeConfiguration(async (change) => {
            if (change.affectsConfiguration("blocksim.path")) {
                await stop();
                await start();
            }
        }),
    );
    await start();
}

module.exports = { activate, deactivate: stop };
