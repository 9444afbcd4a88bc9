// Looks at the extension for VS Code: its package.json names files that are there, and the grammar's own scope. Usage: node vscode.js FOLDER
"use strict";
const fs = require("fs");
const path = require("path");

const folder = process.argv[2];
const read = (name) => JSON.parse(fs.readFileSync(path.join(folder, name), "utf8"));
const wrong = [];
const expect = (yes, words) => yes || wrong.push(words);

const told = read("package.json");
for (const field of ["name", "displayName", "description", "version", "publisher", "license", "engines", "main", "contributes"]) {
  expect(told[field], `package.json has no ${field}`);
}
expect(/^[a-z0-9-]+$/.test(told.name), `${told.name} is no name`);
expect(/^\d+\.\d+\.\d+$/.test(told.version), `${told.version} is no version`);
expect(/^\^\d+\.\d+\.\d+$/.test(told.engines.vscode), `${told.engines.vscode} is no version of VS Code`);
const code = fs.readFileSync(path.join(folder, told.main), "utf8");
const ids = told.contributes.languages.map((language) => language.id);
for (const language of told.contributes.languages) {
  const settings = read(language.configuration);
  expect(settings.comments && settings.comments.lineComment === "#", "comments do not begin with #");
}
for (const grammar of told.contributes.grammars) {
  expect(ids.includes(grammar.language), `a grammar for ${grammar.language}, which is no language here`);
  expect(read(grammar.path).scopeName === grammar.scopeName, `the grammar is not ${grammar.scopeName}`);
}
for (const { command } of told.contributes.commands) {
  expect(code.includes(`"${command}"`), `the command ${command} has no handler`);
}
for (const name of Object.keys(told.contributes.configuration.properties)) {
  const [section, key] = name.split(".");
  expect(code.includes(`getConfiguration("${section}")`) && code.includes(`"${key}"`), `the setting ${name} is not read`);
}
for (const [, name] of code.matchAll(/require\("([^")]+)"\)/g)) {
  const module = name.split("/")[0];
  expect(module === "vscode" || told.dependencies[module], `${module} is not among the dependencies`);
}
wrong.forEach((words) => console.error(`editor: VS Code: ${words}`));
process.exitCode = wrong.length ? 1 : 0;
if (!wrong.length) console.log("editor: the extension for VS Code is whole");
