// Names, sizes and times of files as texts.

export function address(route, file) {
  return `/api/${route}/${file.split("/").map(encodeURIComponent).join("/")}`;
}

export function nameOf(file) {
  return file.slice(file.lastIndexOf("/") + 1);
}

export function folderOf(file) {
  return file.slice(0, Math.max(0, file.lastIndexOf("/")));
}

export function within(folder, name) {
  return folder ? `${folder}/${name}` : name;
}

export function sized(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  if (bytes < 1e6) return `${(bytes / 1e3).toFixed(1)} kB`;
  return `${(bytes / 1e6).toFixed(1)} MB`;
}

export function when(time) {
  return time ? new Date(time).toLocaleString([], { dateStyle: "short", timeStyle: "short" }) : "";
}

// Shorten a long name so that it fits into a sentence.
export function short(file) {
  const letters = [...file];
  return letters.length > 60 ? `${letters.slice(0, 30).join("")}…${letters.slice(-25).join("")}` : file;
}

// Return a name for a copy of a file that isn't used in its folder.
export function free(file, taken) {
  const name = nameOf(file);
  const dot = name.lastIndexOf(".");
  const [stem, ending] = dot > 0 ? [name.slice(0, dot), name.slice(dot)] : [name, ""];
  for (let number = 1; ; number += 1) {
    const made = within(folderOf(file), `${stem} copy${number > 1 ? ` ${number}` : ""}${ending}`);
    if (!taken.has(made)) return made;
  }
}
