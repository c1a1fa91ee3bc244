/** Files of a drop, including those in folders. */
export async function filesOf(items: DataTransferItemList): Promise<File[]> {
  const found: File[] = [];
  const walk = async (entry: FileSystemEntry): Promise<void> => {
    if (entry.isFile) {
      found.push(await new Promise<File>((done, fail) => (entry as FileSystemFileEntry).file(done, fail)));
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {
      const part = await new Promise<FileSystemEntry[]>((done, fail) => reader.readEntries(done, fail));
      if (part.length === 0) return;
      for (const inner of part) await walk(inner);
    }
  };
  const entries = [...items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  for (const entry of entries) await walk(entry);
  return found.filter((file) => !file.name.startsWith('.'));
}

/** Opens the browser's dialog for one file; `accept`: endings, separated by commas. */
export function chooseFile(accept: string, then: (file: File) => void): void {
  const input = document.createElement('input');
  input.type = 'file';
  input.accept = accept;
  input.onchange = () => {
    if (input.files?.[0]) then(input.files[0]);
  };
  input.click();
}

/** Opens the browser's dialog for files, or for a folder. */
export function chooseFiles(folder: boolean, then: (files: File[]) => void): void {
  const input = document.createElement('input');
  input.type = 'file';
  input.multiple = true;
  input.webkitdirectory = folder;
  input.onchange = () => then([...(input.files ?? [])]);
  input.click();
}
