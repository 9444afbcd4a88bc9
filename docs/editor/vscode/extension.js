// Starts `perigrain lsp` and lets it answer about decks.
"use strict";
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

async function start() {
  const command = vscode.workspace.getConfiguration("perigrain").get("path", "perigrain");
  client = new LanguageClient(
    "perigrain",
    "perigrain",
    { command, args: ["lsp"] },
    { documentSelector: [{ language: "perigrain" }] },
  );
  try {
    await client.start();
  } catch (error) {
    vscode.window.showErrorMessage(
      `\`${command} lsp\` does not start (${error.message}): set perigrain.path to the program`,
    );
  }
}

async function stop() {
  const old = client;
  client = undefined;
  if (old && old.needsStop()) {
    await old.stop();
  }
}

async function restart() {
  await stop();
  await start();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("perigrain.restart", restart),
    vscode.workspace.onDidChangeConfiguration(
      (change) => change.affectsConfiguration("perigrain.path") && restart(),
    ),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
