// The grammar gives the tokens of a shipped diagram the scopes that themes colour.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import test from "node:test";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const textmate = require("vscode-textmate");

const here = new URL("../", import.meta.url);
const engine = await readFile(require.resolve("vscode-oniguruma/release/onig.wasm"));
await oniguruma.loadWASM(engine.buffer.slice(engine.byteOffset, engine.byteOffset + engine.byteLength));
const registry = new textmate.Registry({
    onigLib: Promise.resolve({
        createOnigScanner: (sources) => new oniguruma.OnigScanner(sources),
        createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () =>
        textmate.parseRawGrammar(await readFile(new URL("syntaxes/ron.tmLanguage.json", here), "utf8"), "ron.json"),
});
const grammar = await registry.loadGrammar("source.ron");

/** All tokens of a text: the characters, the innermost scope and all scopes. */
function tokens(text) {
    const all = [];
    let state = textmate.INITIAL;
    for (const line of text.split("\n")) {
        const result = grammar.tokenizeLine(line, state);
        state = result.ruleStack;
        for (const { startIndex, endIndex, scopes } of result.tokens) {
            all.push({ text: line.slice(startIndex, endIndex), scope: scopes.at(-1), scopes, line });
        }
    }
    return { all, state };
}

/** The innermost scope of the first token `text` in a line with `line`. */
function scope({ all }, line, text) {
    const found = all.find((token) => token.line.includes(line) && token.text === text);
    assert.ok(found, `no token \`${text}\` in the line \`${line}\``);
    return found.scope;
}

const diagram = (name) => readFile(new URL(`../../../diagrams/${name}`, here), "utf8");

test("a shipped diagram is coloured as it is meant", async () => {
    const servo = tokens(await diagram("servo.ron"));
    for (const [line, text, expected] of [
        ["// Position servo", "// Position servo: a PID controller turns a load by 90 degrees through a DC motor and a gear.", "comment.line.double-slash.ron"],
        ["Diagram(", "Diagram", "keyword.control.structure.ron"],
        ["title:", "title", "keyword.other.section.ron"],
        ["blocks: {", "blocks", "keyword.other.section.ron"],
        ['"inertia": "0.26', "inertia", "entity.name.tag.ron"],
        ['"inertia": "0.26', "0.26", "constant.numeric.ron"],
        ['"inertia": "0.26', "kg*m^2", "keyword.other.unit.ron"],
        ['File("dc_motor.ron")', "File", "support.function.ron"],
        ["stop_time", "stop_time", "variable.parameter.ron"],
        ["stop_time", "Ode45", "entity.name.type.ron"],
        ["stop_time", "1e-6", "constant.numeric.ron"],
        ["anti_windup", "pid", "entity.name.tag.ron"],
        ["anti_windup", "Pid", "entity.name.type.ron"],
        ["anti_windup", "kp", "variable.parameter.ron"],
        ["anti_windup", "8.0", "constant.numeric.ron"],
        ["anti_windup", "Clamping", "entity.name.type.ron"],
        ["ControlledVoltageSource,", "ControlledVoltageSource", "entity.name.type.ron"],
        ['"error.y -> pid.e"', "error", "entity.name.tag.ron"],
        ['"error.y -> pid.e"', "y", "variable.other.member.ron"],
        ['"error.y -> pid.e"', "->", "keyword.operator.arrow.ron"],
        ['"source.p <-> motor.p"', "<->", "keyword.operator.arrow.ron"],
        ['"demand.y -> error.u1', ",", "punctuation.separator.ron"],
    ]) {
        assert.equal(scope(servo, line, text), expected, `${text} in ${line}`);
    }
    // Commas within a connection separate references; the texts of parameters are texts.
    assert.ok(servo.all.find((token) => token.text === "+-").scopes.includes("string.quoted.double.ron"));
});

test("buses, inputs and unclosed texts", () => {
    const part = tokens('connections: ["in.set.Joint1.Angle -> q.u1", "a.y.b -> c.u"], // x');
    assert.equal(scope(part, "in.set", "in"), "variable.language.ron");
    assert.equal(scope(part, "in.set", "set"), "variable.other.member.ron");
    assert.equal(scope(part, "in.set", ".Joint1.Angle"), "variable.other.property.ron");
    assert.equal(scope(part, "in.set", "// x"), "comment.line.double-slash.ron");
    // A connection that is being written ends with its line.
    const half = tokens('connections: [\n    "a.y -> b.u,\n    "c.y -> d.u",\n]');
    assert.equal(scope(half, "c.y", "c"), "entity.name.tag.ron");
    const nested = tokens("/* a /* b */ c */ Gain(k: 2)");
    assert.equal(scope(nested, "Gain", "Gain"), "entity.name.type.ron");
});

test("no diagram of the project leaves anything open or without a scope", async () => {
    const { readdir } = await import("node:fs/promises");
    const folder = new URL("../../../diagrams/", here);
    const files = (await readdir(folder, { recursive: true })).filter((file) => file.endsWith(".ron"));
    assert.ok(files.length > 30, `${files.length} files`);
    for (const file of files) {
        const { all, state } = tokens(await readFile(new URL(file, folder), "utf8"));
        assert.ok(state.equals(textmate.INITIAL) || state.depth === 1, `${file} leaves something open`);
        const bare = all.filter((token) => token.scopes.length === 1 && /[A-Za-z0-9"]/.test(token.text));
        assert.deepEqual(bare.map((token) => token.text), [], file);
    }
});
