// Writes the licence texts of the packages that are in the bundle, and refuses terms that do not fit the project.
import { readFile, readdir, writeFile } from "node:fs/promises";
import path from "node:path";

const allowed = ["MIT", "ISC", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "0BSD"];
const lock = JSON.parse(await readFile("package-lock.json", "utf8"));
const parts = Object.entries(lock.packages).filter(([folder, about]) => folder && !about.dev && !about.optional && !about.devOptional);
let text = "";
for (const [folder, { version, license }] of parts) {
    const name = folder.replace(/^.*node_modules\//, "");
    if (!allowed.includes(license)) {
        throw new Error(`${name} ${version} is under ${license}, which is not among ${allowed.join(", ")}`);
    }
    const file = (await readdir(folder)).find((file) => /^licen[cs]e/i.test(file));
    if (!file) {
        throw new Error(`${name} ${version} has no licence text`);
    }
    text += `${name} ${version} (${license})\n\n${await readFile(path.join(folder, file), "utf8")}\n\n`;
}
await writeFile("dist/THIRD_PARTY_LICENCES.txt", text);
