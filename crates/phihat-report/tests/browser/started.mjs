// `phihat studio`, started in a folder of its own, so that what is saved is nowhere else.

import { spawn } from "node:child_process";
import { copyFileSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { createInterface } from "node:readline";

// On a study with its gains, if any, or on a record: the link, the folder and what stops it.
export async function started(program, { study, gains, record }) {
  const folder = mkdtempSync(join(tmpdir(), "phihat-studio-"));
  if (!record) copyFileSync(study, join(folder, basename(study)));
  const words = ["studio", "--json", ...(record ? ["--replay", resolve(record)] : [basename(study), ...(gains ? ["--gains", resolve(gains)] : [])])];
  const studio = spawn(resolve(program), words, { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  const line = await new Promise((done, fail) => {
    createInterface({ input: studio.stdout }).once("line", done);
    studio.once("exit", (code) => fail(new Error(`phihat studio ended: ${code}`)));
  });
  return { link: JSON.parse(line).open, folder, stop: () => studio.kill() };
}
