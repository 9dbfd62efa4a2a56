// Files that a visitor drops or chooses: what they are, and their texts.

/** Largest file that is read [bytes], and largest text of a link. */
export const LARGEST = 16 * 2 ** 20;
const megabytes = (bytes) => `${(bytes / 2 ** 20).toFixed(1)} MB`;

// Shapes and pictures of a description: nothing here reads them.
const SHAPES = /\.(stl|dae|obj|ply|glb|gltf|mtl|png|jpe?g|tga)$/i;
const STUDY = /^\s*\[(spec|reference|design|loop)\]/m;

/** { gains } a document of gains, { study, name, files } a study, or { file, files, notes } an arm. Throws where there is nothing to read. */
export async function dropped(list) {
  const taken = [...list].filter(({ name }) => !SHAPES.test(name));
  if (!taken.length) throw new Error("shapes alone: drop the description of the arm that they belong to, a URDF, MJCF or xacro");
  const large = taken.find(({ size }) => size > LARGEST);
  if (large) throw new Error(`${large.name}: ${megabytes(large.size)}, and at most ${megabytes(LARGEST)} are read`);
  const read = async (file) => { try { return [file.name, await file.text()]; } catch { throw new Error(`${file.name}: cannot be read; of a folder, drop the files in it`); } };
  const files = Object.fromEntries(await Promise.all(taken.map(read)));
  const names = Object.keys(files);
  const gains = names.find((name) => name.endsWith(".json"));
  if (gains) return { gains: files[gains] };
  const study = names.find((name) => name.endsWith(".toml") && STUDY.test(files[name]));
  if (study) return { study: files[study], name: study.replace(/\.toml$/, "").toLowerCase().replace(/[^a-z0-9_-]/g, "_") || "study", files: Object.fromEntries(Object.entries(files).filter(([name]) => name !== study)) };
  // The description that no other one includes.
  const described = names.filter((name) => /\.(urdf|xml|xacro)$/i.test(name));
  const included = (name) => described.some((other) => other !== name && files[other].includes(name));
  const whole = described.filter((name) => !included(name));
  const [file, ...others] = whole.length ? whole : described.length ? described : names.sort((a, b) => a.endsWith(".toml") - b.endsWith(".toml"));
  const notes = whole.length > 1 ? [`one arm at a time: ${file} is taken, and ${others.join(", ")} left out`] : [];
  return { file, files, notes };
}
