// Figures of a run, as the command line writes them into its files; the page shows one at a time.
const $ = (id) => document.getElementById(id);
let [all, chosen, address] = [[], null, null];

/** Offers figures { name, title, svg }, and shows the one that was chosen before, else the one of this name. */
export function figures(found, name) {
  const wanted = chosen ?? name;
  all = found;
  $("figure").replaceChildren(...all.map((own) => new Option(own.title, own.name)));
  if (all.some((own) => own.name === wanted)) $("figure").value = wanted;
  $("which").hidden = all.length === 0;
  picture();
}

function picture() {
  const own = all.find(({ name }) => name === $("figure").value);
  if (address) URL.revokeObjectURL(address);
  address = own && URL.createObjectURL(new Blob([own.svg], { type: "image/svg+xml" }));
  $("picture").replaceChildren(...(own ? [Object.assign(new Image(), { src: address, alt: own.title })] : []));
}
$("figure").addEventListener("change", () => { chosen = $("figure").value; picture(); });
