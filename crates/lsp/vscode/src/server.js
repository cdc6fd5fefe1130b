// @ts-check
"use strict";

const { spawn } = require("node:child_process");

/**
 * How the language server is started: the program with the one argument `lsp`, which speaks on its standard input and output.
 *
 * @param {string} program the setting `blocksim.path`
 * @param {string | undefined} folder the first folder of the workspace
 */
function serverOptions(program, folder) {
    return { command: program, args: ["lsp"], options: folder ? { cwd: folder } : {} };
}

/**
 * Starts the language server. `ended` is fulfilled when it ends, with what it printed as errors.
 *
 * @param {string} program the setting `blocksim.path`
 * @param {string | undefined} folder the first folder of the workspace
 * @returns {Promise<{ server: import("node:child_process").ChildProcessWithoutNullStreams, ended: Promise<string> }>}
 *     rejected with the reason if the program cannot be started
 */
async function startServer(program, folder) {
    const { command, args, options } = serverOptions(program, folder);
    const server = spawn(command, args, options);
    let errors = "";
    server.stderr.on("data", (data) => {
        errors = (errors + data).slice(-2000);
    });
    // Writing to a server that has ended is no reason to end the editor's extensions.
    server.stdin.on("error", () => {});
    const ended = new Promise((resolve) => server.once("close", () => resolve(errors.trim())));
    await new Promise((resolve, reject) => {
        server.once("spawn", () => resolve(undefined));
        server.once("error", (/** @type {NodeJS.ErrnoException} */ error) =>
            reject(error.code === "ENOENT" ? new Error("there is no such program") : error),
        );
    });
    return { server, ended };
}

/**
 * A message of the program as one sentence for a notice: `error[code]: what` and `= help: remedy`.
 *
 * @param {string} text
 */
function notice(text) {
    const lines = text.split("\n").map((line) => line.trim().replace(/^error\[\w+\]: |^= (help|note): /, ""));
    return lines.filter((line) => line !== "").join("; ");
}

module.exports = { serverOptions, startServer, notice };
