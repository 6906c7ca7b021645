// The token of the address `http://127.0.0.1:PORT/#TOKEN`. It leaves the address at once, so that neither the history nor a
// copied address has it, and stays in the session storage for a reload.

const key = 'proleg.token';

// Takes the token; null if neither the address nor the storage has one. `isOther`: whether a fragment with its # is something else.
export function takeToken(location: Location, history: History, storage: Storage, isOther: (hash: string) => boolean = () => false): string | null {
  const fragment = location.hash.slice(1);
  if (fragment !== '' && !isOther(location.hash)) {
    storage.setItem(key, fragment);
    history.replaceState(null, '', location.pathname + location.search);
  }
  return storage.getItem(key);
}
