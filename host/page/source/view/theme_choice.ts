export type ThemeChoice = 'system' | 'light' | 'dark';

// The choice that looks otherwise than the page does now; that of the system, where it does.
export function otherTheme(isDark: boolean, systemIsDark: boolean): ThemeChoice {
  if (systemIsDark !== isDark) return 'system';
  return isDark ? 'light' : 'dark';
}
