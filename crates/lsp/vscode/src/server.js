// @ts-check
"use strict";

/**
 * How the language server is started: the program with the one argument `lsp`, which speaks on its standard input and output.
 *
 * @param {string} program the setting `blocksim.path`
 * @param {string | undefined} folder the first folder of the workspace
 */
function serverOptions(program, folder) {
    return { command: program, args: ["lsp"], options: folder ? { cwd: folder } : {} };
}

module.exports = { serverOptions };
