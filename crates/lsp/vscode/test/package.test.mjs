// The packaged file holds what the editor loads, and nothing else.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { readFile } from "node:fs/promises";
import test from "node:test";

const require = createRequire(import.meta.url);
const yauzl = require("yauzl");
const manifest = require("../package.json");
const file = new URL("../dist/blocksim.vsix", import.meta.url);

/** Names of the entries of a zip file. */
async function entries() {
    const bytes = await readFile(file);
    return new Promise((resolve, reject) => {
        yauzl.fromBuffer(bytes, (error, zip) => {
            if (error) return reject(error);
            const names = [];
            zip.on("entry", (entry) => names.push(entry.fileName));
            zip.on("end", () => resolve(names));
            zip.on("error", reject);
        });
    });
}

test("the package is whole and small", async () => {
    const names = await entries();
    const parts = [
        manifest.main,
        "dist/THIRD_PARTY_LICENCES.txt",
        "LICENSE.txt",
        ...manifest.contributes.grammars.map(({ path }) => path),
        ...manifest.contributes.languages.map(({ configuration }) => configuration),
    ];
    for (const part of ["extension.vsixmanifest", ...parts.map((part) => `extension/${part.replace("./", "")}`)]) {
        assert.ok(names.includes(part), `${part} is missing: ${names}`);
    }
    const strays = names.filter((name) => /node_modules|\/src\/|\/test\//.test(name));
    assert.deepEqual(strays, []);
    const { length } = await readFile(file);
    assert.ok(length < 1_000_000, `${length} bytes`);
});

test("the bundle needs nothing but the editor and Node", async () => {
    const bundle = await readFile(new URL("../dist/extension.js", import.meta.url), "utf8");
    const { builtinModules } = require("node:module");
    const needed = new Set([...bundle.matchAll(/\brequire\("([^"]+)"\)/g)].map(([, name]) => name.replace(/^node:/, "")));
    const foreign = [...needed].filter((name) => name !== "vscode" && !builtinModules.includes(name));
    assert.deepEqual(foreign, []);
});
