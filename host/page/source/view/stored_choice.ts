// Choices of the user that the browser keeps.

// A page from a file may have no storage.
function storage(): Storage | null {
  try {
    return window.localStorage;
  } catch {
    return null;
  }
}

export function storedChoice(key: string): string | null {
  return storage()?.getItem(key) ?? null;
}

export function storeChoice(key: string, choice: string): void {
  storage()?.setItem(key, choice);
}
