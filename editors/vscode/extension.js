// Starts `vpost lsp` for NC programs, and hands it the settings. All else is the server's.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

/** The settings as the server takes them: options as a manifest of vpost has them, and `language`. */
function settings() {
  const own = vscode.workspace.getConfiguration("vpost");
  const [machine, dialect, language] = ["machine", "dialect", "language"].map((key) => own.get(key) || null);
  return { ...own.get("options"), machine, dialect, language };
}

exports.activate = async (context) => {
  const command = vscode.workspace.getConfiguration("vpost").get("command");
  client = new LanguageClient(
    "vpost",
    "vpost",
    { command, args: ["lsp"] },
    {
      documentSelector: [{ language: "nc" }],
      initializationOptions: settings(),
      synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{toml,csv}") },
    },
  );
  context.subscriptions.push(
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("vpost")) {
        client.sendNotification("workspace/didChangeConfiguration", { settings: { vpost: settings() } });
      }
    }),
  );
  await client.start();
};

exports.deactivate = () => client && client.stop();
