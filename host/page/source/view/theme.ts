// The theme, light or dark: that of the system, or the one that was chosen here.
import { computed, effect, signal } from '@preact/signals-core';

export type ThemeChoice = 'system' | 'light' | 'dark';

const key = 'proleg.theme';
const order: readonly ThemeChoice[] = ['system', 'light', 'dark'];

const query = window.matchMedia('(prefers-color-scheme: dark)');
const systemIsDark = signal(query.matches);
query.addEventListener('change', () => (systemIsDark.value = query.matches));

// A page from a file may have no storage.
function storage(): Storage | null {
  try {
    return window.localStorage;
  } catch {
    return null;
  }
}

function storedChoice(): ThemeChoice {
  const stored = storage()?.getItem(key);
  return order.find((choice) => choice === stored) ?? 'system';
}

export const themeChoice = signal<ThemeChoice>(storedChoice());

export const isDark = computed(() =>
  themeChoice.value === 'system' ? systemIsDark.value : themeChoice.value === 'dark',
);

effect(() => {
  document.documentElement.dataset['theme'] = isDark.value ? 'dark' : 'light';
});

export function nextTheme(): void {
  const next = order[(order.indexOf(themeChoice.value) + 1) % order.length] as ThemeChoice;
  storage()?.setItem(key, next);
  themeChoice.value = next;
}
