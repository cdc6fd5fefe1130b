// @ts-check
"use strict";

/**
 * The command lines behind the commands of the editor. A file may be named like an option, so `--` stands before it.
 *
 * @type {Record<string, (file: string) => string[]>}
 */
const commandLines = {
    "blocksim.run": (file) => ["run", "--", file],
    "blocksim.check": (file) => ["check", "--", file],
    "blocksim.report": () => ["report", "latest", "--open", "--yes"],
};

/**
 * The command line that draws the top level of a diagram.
 *
 * @param {string} file
 * @param {string} svg where the drawing is written
 * @param {boolean} dark
 */
function drawing(file, svg, dark) {
    return ["graph", "--svg", svg, "--yes", "--theme", dark ? "dark" : "light", "--", file];
}

module.exports = { commandLines, drawing };
