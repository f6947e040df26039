// A little interpreter: a stack, a switch, a table of codes.
// expect: 7 9
const int PUSH = 0, ADD = 1, MUL = 2, END = 3;
const int program[8] = int[8](PUSH, PUSH, ADD, PUSH, MUL, END, END, END);
float evaluate(float values[3], int limit)
{
    float stack[4];
    int top = 0, value = 0;
    for (int at = 0; at < limit; at++) {
        switch (program[at]) {
        case PUSH: stack[top++] = values[value++]; continue;
        case ADD: --top; stack[top - 1] += stack[top]; break;
        case MUL: { top--; stack[top - 1] *= stack[top]; } break;
        case END: return stack[0];
        }
        if (top == 0)
            break;
    }
    return stack[top - 1];
}
void main()
{
    result[0] = evaluate(float[3](three, half_, two), 5);
    result[1] = evaluate(float[3](one, two, three), 8);
}
