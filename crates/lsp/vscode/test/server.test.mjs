// The client starts the server as the extension does and speaks with it about a shipped diagram.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import test from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";

const require = createRequire(import.meta.url);
const rpc = require("vscode-jsonrpc/node");
const { notice, serverOptions, startServer } = require("../src/server.js");
const { commandLines, drawing } = require("../src/commands.js");
const manifest = require("../package.json");

const root = fileURLToPath(new URL("../../../../", import.meta.url));
const program = path.resolve(process.env.BLOCKSIM ?? path.join(root, "target/debug/blocksim"));

test("a server that does not start says why", { timeout: 60_000 }, async () => {
    await assert.rejects(startServer(path.join(root, "nosuch/blocksim"), root), /there is no such program/);
    // A program that ends at once, as one without a language server does.
    const { ended } = await startServer(process.execPath, path.join(root, "docs"));
    const errors = await ended;
    assert.match(errors, /Cannot find module .*lsp/);
    const text = "error[left_out]: cannot serve an editor\n  = help: build it with `--features lsp`\n";
    assert.equal(notice(text), "cannot serve an editor; build it with `--features lsp`");
});

test("the server is started, completes, renames and stops", { timeout: 60_000 }, async (context) => {
    const home = await mkdtemp(path.join(tmpdir(), "blocksim-client-"));
    const { command, args, options } = serverOptions(program, root);
    const server = spawn(command, args, { ...options, env: { ...process.env, BLOCKSIM_HOME: home } });
    const connection = rpc.createMessageConnection(
        new rpc.StreamMessageReader(server.stdout),
        new rpc.StreamMessageWriter(server.stdin),
    );
    // A server that is left behind would keep the tests from ending, and what it has written is the reason of a failure.
    let errors = "";
    server.stderr.on("data", (piece) => (errors += piece));
    context.after(async () => {
        server.kill();
        connection.dispose();
        if (errors) context.diagnostic(errors);
        await rm(home, { recursive: true, force: true });
    });
    const ended = new Promise((resolve) => server.on("exit", resolve));
    const file = path.join(root, "diagrams/servo.ron");
    const uri = pathToFileURL(file).href;
    const text = await readFile(file, "utf8");
    const problems = [];
    let told;
    const firstTold = new Promise((resolve) => (told = resolve));
    connection.onNotification("textDocument/publishDiagnostics", (params) => {
        problems.push(params);
        if (params.uri === uri && params.diagnostics.length > 0) told(params.diagnostics);
    });
    connection.listen();
    const folder = { uri: pathToFileURL(root).href, name: "blocksim" };
    const answer = await connection.sendRequest("initialize", {
        processId: process.pid,
        rootUri: folder.uri,
        workspaceFolders: [folder],
        capabilities: {},
    });
    assert.equal(answer.serverInfo.name, "blocksim");
    assert.equal(answer.capabilities.textDocumentSync.change, 2, "texts are synchronised by their changes");
    assert.equal(answer.capabilities.renameProvider.prepareProvider, true);
    await connection.sendNotification("initialized", {});
    const open = (version, text) => ({ textDocument: { uri, languageId: "ron", version, text } });
    await connection.sendNotification("textDocument/didOpen", open(1, text));
    // A slip, typed as a change of one letter.
    const lines = text.split("\n");
    const line = lines.findIndex((one) => one.includes("DcMotor"));
    const character = lines[line].indexOf("DcMotor");
    const range = { start: { line, character }, end: { line, character: character + 7 } };
    const change = (version, text) => ({ textDocument: { uri, version }, contentChanges: [{ range, text }] });
    await connection.sendNotification("textDocument/didChange", change(2, "DcMotr_"));
    const [problem] = await firstTold;
    assert.equal(problem.code, "unknown_block");
    assert.match(problem.message, /did you mean `DcMotor`/);
    await connection.sendNotification("textDocument/didChange", change(3, "DcMotor"));
    const at = { line: lines.findIndex((one) => one.includes('"pid": Pid')), character: 10 };
    const edit = await connection.sendRequest("textDocument/rename", {
        textDocument: { uri },
        position: at,
        newName: "controller",
    });
    assert.deepEqual(Object.keys(edit.changes), [uri]);
    assert.equal(edit.changes[uri].length, 3, "the declaration and two connections");
    const hover = await connection.sendRequest("textDocument/hover", { textDocument: { uri }, position: at });
    assert.match(hover.contents.value, /\*\*pid\*\*: Pid/);
    await connection.sendRequest("shutdown");
    await connection.sendNotification("exit");
    assert.equal(await ended, 0);
});

/** Runs the program to its end. */
async function run(args) {
    const child = spawn(program, args, { cwd: root });
    let output = "";
    child.stdout.on("data", (data) => (output += data));
    child.stderr.on("data", (data) => (output += data));
    return { code: await new Promise((resolve) => child.on("exit", resolve)), output };
}

test("the command lines are those of the program", { timeout: 60_000 }, async () => {
    const servo = path.join(root, "diagrams/servo.ron");
    const folder = await mkdtemp(path.join(tmpdir(), "blocksim-client-"));
    const checked = await run(commandLines["blocksim.check"](servo));
    assert.equal(checked.code, 0, checked.output);
    const svg = path.join(folder, "servo.svg");
    const drawn = await run(drawing(servo, svg, true));
    assert.equal(drawn.code, 0, drawn.output);
    assert.match(await readFile(svg, "utf8"), /<svg[^>]*>[\s\S]*encoder/);
    // What is not run here is at least known: a wrong option is an error of usage.
    for (const name of ["blocksim.run", "blocksim.report"]) {
        const { output } = await run([...commandLines[name](servo).filter((part) => part !== "--" && part !== servo && part !== "latest"), "--help"]);
        assert.match(output, /Usage: blocksim (run|report)/, output);
    }
    await rm(folder, { recursive: true, force: true });
});

test("every command of the manifest is registered, and every registered one is in the manifest", async () => {
    const source = await readFile(new URL("../src/extension.js", import.meta.url), "utf8");
    const registered = [...source.matchAll(/register\("(blocksim\.\w+)"/g)].map(([, name]) => name);
    registered.push(...Object.keys(commandLines));
    const declared = manifest.contributes.commands.map(({ command }) => command);
    assert.deepEqual(registered.sort(), declared.sort());
});
