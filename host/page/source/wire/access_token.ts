// The token of the address `http://127.0.0.1:PORT/#TOKEN`. It leaves the address at once, so that neither the history nor a
// copied address has it, and stays in the session storage for a reload.

// Several seats of a class share an origin, and a tab may show one after the other.
function keyOf({ pathname }: Pick<Location, 'pathname'>): string {
  return pathname === '/' ? 'proleg.token' : `proleg.token${pathname}`;
}

// Takes the token; null if neither the address nor the storage has one. `fragment`: that of the address, without its #, if it
// is the token.
export function takeToken(location: Location, history: History, storage: Storage, fragment = location.hash.slice(1)): string | null {
  const key = keyOf(location);
  if (fragment !== '') {
    storage.setItem(key, fragment);
    history.replaceState(null, '', location.pathname + location.search);
  }
  return storage.getItem(key);
}

// Forgets a token that the program has refused.
export function dropToken(location: Location, storage: Storage): void {
  storage.removeItem(keyOf(location));
}
