/** Fruit for people: "cucumber_2_fruit_0" is "Cucumber 3.1", the first fruit of the third plant. */

import { type Key, t } from "./i18n";

const NAME = /\b(cucumber|tomato|grape)_(\d+)_fruit_(\d+)\b/g;

/** A text with every fruit in it called as people do. */
export function fruitWords(text: string): string {
  return text.replace(NAME, (_, crop: string, plant: string, fruit: string) =>
    t("task.fruit", { crop: t(`crop.${crop}` as Key), plant: Number(plant) + 1, fruit: Number(fruit) + 1 }),
  );
}
