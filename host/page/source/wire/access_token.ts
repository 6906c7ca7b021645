// The token of the address `http://127.0.0.1:PORT/#TOKEN`. It leaves the address at once, so that neither the history nor a
// copied address has it, and stays in the session storage for a reload.

const key = 'proleg.token';

// Takes the token; null if neither the address nor the storage has one.
export function takeToken(location: Location, history: History, storage: Storage): string | null {
  const fragment = location.hash.slice(1);
  if (fragment !== '') {
    storage.setItem(key, fragment);
    history.replaceState(null, '', location.pathname + location.search);
  }
  return storage.getItem(key);
}
