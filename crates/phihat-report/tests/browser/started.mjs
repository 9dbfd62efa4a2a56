// `phihat studio`, started in a folder of its own, so that what is saved is nowhere else.

import { spawn } from "node:child_process";
import { copyFileSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { createInterface } from "node:readline";

// On a study with its gains, if any, on a record, on a log with its study, or on files of one's own (name and text), the first of them the
// study: the link, the folder and what stops it.
export async function started(program, { study, gains, record, log, files }) {
  const folder = mkdtempSync(join(tmpdir(), "phihat-studio-"));
  if (study) copyFileSync(study, join(folder, basename(study)));
  for (const [name, text] of files ?? []) writeFileSync(join(folder, name), text);
  const own = study ? basename(study) : files?.[0][0];
  const words = ["studio", "--json", ...(own ? [own] : []), ...(gains ? ["--gains", resolve(gains)] : []), ...(record ?? log ? ["--replay", resolve(record ?? log)] : [])];
  const studio = spawn(resolve(program), words, { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  const line = await new Promise((done, fail) => {
    createInterface({ input: studio.stdout }).once("line", done);
    studio.once("exit", (code) => fail(new Error(`phihat studio ended: ${code}`)));
  });
  return { link: JSON.parse(line).open, folder, stop: () => studio.kill() };
}
