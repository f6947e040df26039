// Structs that change places.
// expect: 1 2 3
struct Item { float key; int id; };
void main()
{
    Item items[3] = Item[3](Item(three, 3), Item(one, 1), Item(two, 2));
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (items[j].key > items[j + 1].key) {
                Item t = items[j];
                items[j] = items[j + 1];
                items[j + 1] = t;
            }
    for (int i = 0; i < 3; i++)
        result[i] = float(items[i].id);
}
